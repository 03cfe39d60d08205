//! The warped patch (Park, Guo, Shin, Qin 2006) against surfaces and colours whose truth is known.

use crate::checker::complete_checked;
use crate::fragment::{broken_relief, options, rms};
use crate::sources::moved;
use complete_mesh::{
    Completer, Error, Grouping, Guidance, Method, Monitor, Options, Placement, Sources,
};
use glam::DVec3;
use std::sync::Arc;

/// What repeats itself is found and lies where its source says.
#[test]
fn a_periodic_relief_is_recovered() {
    let mesh = broken_relief();
    let [smooth, warped] =
        [Method::Smooth, Method::Warp].map(|m| complete_checked(&mesh, &options(m)));
    let [bare, own] = [&smooth, &warped].map(rms);
    println!("smooth {bare:.1e}, warped {own:.1e}");
    assert!(own < 0.1 * bare, "{own} {bare}");
    let hole = warped.holes.iter().find(|h| h.method == Method::Warp).unwrap();
    assert!(hole.confidence > 0.9 && hole.sources.len() == 1, "{}", hole.summary());
    for (p, origin) in warped.vertices.iter().zip(&warped.origins) {
        let face = mesh.faces[origin.face as usize].map(|v| DVec3::from(mesh.vertices[v as usize]));
        let there: DVec3 = (0..3).map(|k| origin.barycentric[k] * face[k]).sum();
        let apart = hole.sources[0].transform.point(there).distance(DVec3::from(*p));
        assert!(apart < 0.3 * bare, "{apart} {bare}");
    }
}

/// Another piece of the relief, turned, or mirrored, as exemplar: the fill comes from it alone.
#[test]
fn an_exemplar_gives_back_what_is_missing() {
    let broken = broken_relief();
    let bare = rms(&complete_checked(&broken, &options(Method::Smooth)));
    for mirrored in [false, true] {
        let exemplar = Some(Arc::new(moved(&broken, mirrored)));
        let sources = Sources { exemplar, exemplar_only: true, ..Sources::default() };
        let made = complete_checked(&broken, &Options { sources, ..options(Method::Warp) });
        let own = rms(&made);
        println!("mirrored {mirrored}: {own:.1e}, smooth {bare:.1e}");
        assert!(own < 0.1 * bare, "{own} {bare}");
        let (first, count) = (broken.faces.len() as u32, broken.faces.len() as u32);
        assert!(made.origins.iter().all(|o| (first..first + count).contains(&o.face)));
        let hole = made.holes.iter().find(|h| h.method == Method::Warp).unwrap();
        assert!(hole.confidence > 0.9, "{}", hole.summary());
    }
}

/// A candidate is what it alone makes, and the best of them what comes out without a choice; its transform
/// given by hand makes it again.
#[test]
fn candidates_and_placements_are_heeded() {
    let mesh = broken_relief();
    let with = |guidance| Options { guidance, ..options(Method::Warp) };
    let completer = Completer::new(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let all = completer.candidates(3, &options(Method::Warp), &Monitor::silent()).unwrap();
    let plain = complete_checked(&mesh, &options(Method::Warp));
    assert!(
        all.len() > 1 && all[0].vertices == plain.vertices && all[1].vertices != plain.vertices
    );
    let hole = all[1].holes.iter().find(|h| h.method == Method::Warp).unwrap();
    let transform = hole.sources[0].transform;
    let placement = Some(Placement { transform, refined: false });
    let placed = complete_checked(&mesh, &with(Guidance { placement, ..Guidance::default() }));
    assert_eq!(placed.vertices, all[1].vertices);
    let scales = with(Guidance { scales: Some([0.5, 2.0]), ..Guidance::default() });
    let refused = complete_mesh::complete_mesh(&mesh.vertices[..], &mesh.faces[..], &scales);
    assert!(matches!(refused, Err(Error::InvalidOption { name: "scales", .. })));
}
