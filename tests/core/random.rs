//! Random sheets with random holes: the contract, or an error that says so.

use crate::checker::{check, filled_rims};
use crate::meshes::sheet;
use complete_mesh::{
    complete_mesh, find_holes, Error, Fairing, Grouping, HoleStatus, Monitor, Options, Selection,
    Sizing,
};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn contract_or_error(
        heights in prop::collection::vec(-1.0f64..1.0, 13 * 13),
        shifts in prop::collection::vec(-0.3f64..0.3, 13 * 13),
        cells in prop::collection::hash_set((1usize..11, 1usize..11), 1..14),
        fairing in 0usize..Fairing::ALL.len(),
        sizing in prop::sample::select(
            &[Sizing::Surroundings, Sizing::None, Sizing::Scaled(0.5), Sizing::EdgeLength(0.7)][..]
        ),
        skip_unsafe: bool,
    ) {
        let place = |x: f64, y: f64| {
            let i = y as usize * 13 + x as usize;
            [x + shifts[i], y + shifts[168 - i], heights[i]]
        };
        let mesh = sheet((12, 12), place, |i, j| !cells.contains(&(i, j)));
        let options = Options {
            fairing: Fairing::ALL[fairing],
            sizing,
            skip_unsafe,
            selection: Selection::AllButLargest,
            ..Options::default()
        };
        let list =
            find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
        match complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options) {
            Ok(made) => {
                let open = |s: &HoleStatus| matches!(s, HoleStatus::Unsafe(_) | HoleStatus::Failed(_));
                prop_assert!(skip_unsafe || !made.holes.iter().any(|h| open(&h.status)));
                let checked =
                    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list));
                prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
            }
            Err(Error::UnsafeHole { hole, problem }) => {
                prop_assert!(!skip_unsafe);
                prop_assert_eq!(list.holes[hole].problem.as_ref(), Some(&problem));
            }
            Err(Error::HoleFailed { .. }) => prop_assert!(!skip_unsafe),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
