//! Rims where a fill need only be joined: what lies beyond says nothing of it.

use crate::appearance::painted;
use crate::checker::{check, filled_rims};
use crate::meshes::{sheet, within, Mesh};
use complete_mesh::{
    complete_mesh, find_holes, Completer, Completion, Error, Fairing, Grouping, Guidance, Method,
    Monitor, Options, Selection,
};
use glam::DVec3;

/// Two planes at right angles, the fold at x = 20, and a hole in the first that ends at the fold; and the rim
/// vertices there.
fn fold() -> (Mesh, Vec<u32>) {
    let place = |x: f64, y: f64| match x <= 20.0 {
        true => [x, y, 0.0],
        false => [20.0, y, x - 20.0],
    };
    let mesh = sheet((40, 32), place, |i, j| !(within(i, j, 10, 20) && i >= 10));
    let on_fold = (10..=20).map(|y| mesh.at([20.0, f64::from(y), 0.0])).collect();
    (mesh, on_fold)
}

fn fill(mesh: &Mesh, loose: &[u32], fairing: Fairing, method: Method) -> Completion {
    let guidance = Guidance { loose: loose.into(), ..Guidance::default() };
    let selection = Selection::AllButLargest;
    let options = Options { method, fairing, selection, guidance, ..Options::default() };
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    let list = find_holes(mesh.view(), &options.grouping, &Monitor::silent()).unwrap();
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
    made
}

fn highest(made: &Completion) -> f64 {
    made.vertices.iter().fold(0.0, |z: f64, p| z.max(p[2].abs()))
}

/// The other plane pulls a fill that goes on from it; one that is only joined to it lies in its own plane.
#[test]
fn a_fold_is_kept() {
    let (mesh, on_fold) = fold();
    let [kept, pulled] = [&on_fold[..], &[]].map(|l| fill(&mesh, l, Fairing::C1, Method::Smooth));
    println!("{:.1e} {:.2}", highest(&kept), highest(&pulled));
    assert!(highest(&kept) < 1e-8 && highest(&pulled) > 0.3);
    for method in [Method::Smooth, Method::Coherent, Method::Warp] {
        let [kept, pulled] = [&on_fold[..], &[]].map(|l| fill(&mesh, l, Fairing::Auto, method));
        println!("{}: {:.3} {:.3}", method.name(), highest(&kept), highest(&pulled));
        assert!(highest(&kept) < 0.1);
    }
}

/// A completer that filled the hole otherwise before gives the same as one that did not.
#[test]
fn what_was_joined_before_does_not_matter() {
    let (mesh, on_fold) = fold();
    let kept = Completer::new(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    for method in [Method::Smooth, Method::Coherent] {
        for loose in [&[], &on_fold[..], &on_fold[..4], &[]] {
            let guidance = Guidance { loose: loose.into(), ..Guidance::default() };
            let selection = Selection::AllButLargest;
            let options = Options { method, selection, guidance, ..Options::default() };
            let made = kept.complete(&options, &Monitor::silent()).unwrap();
            let fresh = fill(&mesh, loose, Fairing::Auto, method);
            assert_eq!(made.vertices, fresh.vertices, "{} {}", method.name(), loose.len());
        }
    }
}

/// Colours go on from the fill's own plane alone.
#[test]
fn colours_end_at_the_fold() {
    let (mesh, on_fold) = fold();
    let colour = |p: DVec3| vec![if p.x > 19.5 { 9.0 } else { 1.0 + 0.1 * p.y }];
    let values = painted(&mesh, &colour, 1);
    let greatest = |loose: &[u32]| {
        let made = fill(&mesh, loose, Fairing::C1, Method::Smooth);
        let found = values.complete((&mesh.faces[..]).into(), None, &made);
        for (p, value) in made.vertices.iter().zip(&found) {
            let off = (value - colour(DVec3::new(0.0, p[1], 0.0))[0]).abs();
            assert!(loose.is_empty() || off < 0.1, "{p:?} {value}");
        }
        found.into_iter().fold(0.0, f64::max)
    };
    assert!(greatest(&on_fold) < 3.0 && greatest(&[]) > 6.0);
}

/// A rim that is loose all around still gives its colours and its border.
#[test]
fn a_loose_rim_still_closes() {
    let (mesh, _) = fold();
    let list = find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let rim = &list.loops.iter().min_by_key(|l| l.vertices.len()).unwrap().vertices;
    let values = painted(&mesh, &|_| vec![4.0], 1);
    for method in [Method::Smooth, Method::Coherent] {
        let made = fill(&mesh, rim, Fairing::Auto, method);
        assert!(made.vertices.len() > 50 && made.vertices.iter().all(|p| p[2] < 1.0));
        let found = values.complete((&mesh.faces[..]).into(), None, &made);
        assert!(found.iter().all(|x| (x - 4.0).abs() < 1e-3));
    }
}

#[test]
fn vertices_that_are_on_no_rim_are_named() {
    let (mesh, _) = fold();
    let inner = mesh.at([5.0, 5.0, 0.0]);
    let refused = |method, loose: u32| {
        let guidance = Guidance { loose: [loose].into(), ..Guidance::default() };
        let options = Options { method, guidance, ..Options::default() };
        match complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options) {
            Err(Error::InvalidOption { name: "loose", reason }) => reason,
            other => panic!("{other:?}"),
        }
    };
    for v in [inner, u32::MAX] {
        assert!(refused(Method::Smooth, v).contains(&format!("vertex {v} is on no rim")));
    }
    assert!(refused(Method::Harary, inner).contains("harary"));
}
