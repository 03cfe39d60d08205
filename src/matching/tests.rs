use super::consistent::{find_consistent, propose_by_descriptor, Place};
use super::rigid::Rigid;
use crate::descriptor::spectrum::Random;
use crate::descriptor::tests::sphere;
use crate::error::Error;
use crate::progress::Monitor;
use glam::{DMat3, DVec3};

fn unit(random: &mut Random) -> f64 {
    (random.next_bits() >> 11) as f64 / (1u64 << 53) as f64
}

/// A point of a wavy surface over the unit square, with its normal.
fn place(random: &mut Random) -> Place {
    let (x, y) = (unit(random), unit(random));
    let (z, dx, dy) =
        (0.3 * (4.0 * x).sin() + 0.2 * (5.0 * y).cos(), 1.2 * (4.0 * x).cos(), -(5.0 * y).sin());
    Place { point: DVec3::new(x, y, z), normal: DVec3::new(-dx, -dy, 1.0).normalize() }
}

fn moved(t: &Rigid, p: &Place) -> Place {
    Place { point: t.point(p.point), normal: t.direction(p.normal) }
}

fn some_transform(mirrored: bool) -> Rigid {
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, -1.0, 0.8).normalize(), 1.9);
    let flip = DMat3::from_diagonal(DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
    Rigid { linear: turn * flip, translation: DVec3::new(4.0, -2.0, 1.0) }
}

/// One pair in five is right and off by up to 0.01; the others lie anywhere.
#[test]
fn transforms_are_found_among_outliers() {
    for mirrored in [false, true] {
        let truth = some_transform(mirrored);
        let mut random = Random(77);
        let targets: Vec<Place> = (0..100).map(|_| place(&mut random)).collect();
        let mut candidates = Vec::new();
        for t in &targets {
            let mut all: Vec<Place> =
                (0..4).map(|_| moved(&truth.inverse(), &place(&mut random))).collect();
            let mut right = moved(&truth.inverse(), t);
            right.point += 0.01 * DVec3::new(unit(&mut random) - 0.5, unit(&mut random) - 0.5, 0.0);
            all.insert((random.next_bits() % 5) as usize, right);
            candidates.push(all);
        }
        let monitor = Monitor::silent();
        let found = find_consistent(&targets, &candidates, 0.04, &monitor).unwrap();
        assert!(found.is_sorted_by(|a, b| a.votes >= b.votes) && found.len() <= 20);
        let best = found[0];
        assert!(best.votes >= 95, "{}", best.votes);
        assert_eq!(best.transform.is_mirrored(), mirrored);
        for t in &targets {
            let off = best.transform.point(truth.inverse().point(t.point)).distance(t.point);
            assert!(off < 0.02, "{off}");
        }
        let again = find_consistent(&targets, &candidates, 0.04, &monitor).unwrap();
        assert_eq!(found, again);
    }
}

/// Two places fit, one of them mirrored, with 60 and 40 of 100 targets.
#[test]
fn the_second_best_is_found_too() {
    let truths = [some_transform(false), some_transform(true)];
    let mut random = Random(5);
    let targets: Vec<Place> = (0..100).map(|_| place(&mut random)).collect();
    let candidates: Vec<Vec<Place>> = (targets.iter().enumerate())
        .map(|(i, t)| vec![moved(&truths[usize::from(i % 5 > 2)].inverse(), t)])
        .collect();
    let found = find_consistent(&targets, &candidates, 0.03, &Monitor::silent()).unwrap();
    assert_eq!(found[0].votes, 60);
    assert_eq!(found[1].votes, 40);
    assert!(!found[0].transform.is_mirrored() && found[1].transform.is_mirrored());
}

#[test]
fn nothing_to_go_by_gives_nothing() {
    let monitor = Monitor::silent();
    assert!(find_consistent(&[], &[], 1.0, &monitor).unwrap().is_empty());
    let lone = place(&mut Random(1));
    let found = find_consistent(&[lone; 4], &vec![vec![lone]; 4], 1.0, &monitor).unwrap();
    assert!(found.is_empty(), "targets in one place say nothing");
    let (p, f) = sphere(2);
    for everything in [false, true] {
        let is_target = vec![everything; p.len()];
        assert!(propose_by_descriptor(&p, &f, &is_target, 0.2, &monitor).unwrap().is_empty());
    }
    monitor.cancel();
    let result = propose_by_descriptor(&p, &f, &[false; 66], 0.2, &monitor);
    assert_eq!(result.err(), Some(Error::Cancelled));
}

/// A sphere with the same lopsided bump on the left and on the right, mirrored; the crown of the
/// left one is flattened, as a smooth fill would. The best proposal is the mirror.
#[test]
fn a_flattened_bump_is_proposed_its_mirrored_twin() {
    let (mut p, f) = sphere(5);
    let crown = DVec3::new(-1.0, 0.3, 0.4).normalize();
    let mut is_target = vec![false; p.len()];
    for (q, is_target) in p.iter_mut().zip(&mut is_target) {
        let d = *q;
        let bump = |at: DVec3, height: f64, width: f64| {
            height * (-d.distance_squared(at.normalize()) / (width * width)).exp()
        };
        let sides = [-1.0, 1.0].map(|s| {
            bump(DVec3::new(s, 0.3, 0.4), 0.3, 0.3)
                + bump(DVec3::new(s, 0.8, 0.3), -0.15, 0.25)
                + bump(DVec3::new(s, 0.2, 1.2), 0.1, 0.2)
        });
        *is_target = d.distance(crown) < 0.15;
        let left = if *is_target { sides[0].min(0.25) } else { sides[0] };
        let front = bump(DVec3::new(0.0, 0.2, 1.0), 0.25, 0.3);
        *q = d * (1.0 + left + sides[1] + front) * DVec3::new(1.0, 1.2, 0.95);
    }
    let found = propose_by_descriptor(&p, &f, &is_target, 0.25, &Monitor::silent()).unwrap();
    let best = found.first().expect("a proposal");
    assert!(best.transform.is_mirrored());
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    for (q, _) in p.iter().zip(&is_target).filter(|x| *x.1) {
        let off = best.transform.point(*q * mirror).distance(*q);
        assert!(off < 0.15, "{off}");
    }
}
