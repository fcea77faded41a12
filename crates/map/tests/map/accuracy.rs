//! Scenes whose planes are known.

use terrace::{Params, PlaneMap};
use terrace_synth::{Scene, Synthetic};

use crate::common::{PRESETS, angle, check_sound};

/// How one true plane was found: the share of its points on the plane that holds most of them, the share of that plane's
/// points that are its own, the angle and the offset at the true centroid.
#[derive(Debug)]
struct Match {
    name: &'static str,
    found: f64,
    pure: f64,
    angle: f64,
    offset: f64,
}

fn matches(made: &Synthetic, map: &PlaneMap, least: usize) -> Vec<Match> {
    let truth: Vec<_> = made.scans.iter().flat_map(|s| &s.labels).collect();
    let large = made.planes.iter().filter(|p| p.points >= least);
    large
        .filter_map(|plane| {
            let mut shared = vec![0_u64; map.planes.len()];
            for (label, found) in truth.iter().zip(&map.labels) {
                if let (true, Some(found)) = (**label == Some(plane.id), found) {
                    shared[found.index()] += 1;
                }
            }
            let best = (0..shared.len()).max_by_key(|i| shared[*i])?;
            let other = &map.planes[best];
            Some(Match {
                name: plane.name,
                found: shared[best] as f64 / plane.points as f64,
                pure: shared[best] as f64 / other.points as f64,
                angle: angle(plane.plane.normal(), other.plane.normal()),
                offset: other.plane.signed_distance(plane.centroid?).abs(),
            })
        })
        .collect()
}

fn scanned(scene: &Scene, params: Params, points: usize, seed: u64) -> (Synthetic, PlaneMap) {
    let made = scene.generate(&terrace_synth::Params { points: Some(points), sigma: None, seed }).unwrap();
    let map = crate::common::map_of(params, &made.scans);
    check_sound(&map);
    assert!(map.planes.iter().all(|p| p.normal_uncertainty.iter().flatten().all(|s| *s > 0.0)), "s of zero");
    (made, map)
}

/// All but the planes named `parted`, of which half of the points are enough, are no worse than `worst`.
fn check(made: &Synthetic, map: &PlaneMap, least: usize, worst: &Match, parted: &[&str]) {
    let matches = matches(made, map, least);
    assert_eq!(matches.len(), made.planes.iter().filter(|p| p.points >= least).count());
    for m in matches {
        let found = if parted.contains(&m.name) { 0.5 } else { worst.found };
        let good =
            m.found >= found && m.pure >= worst.pure && m.angle <= worst.angle && m.offset <= worst.offset;
        assert!(good, "{}: {m:?} is worse than {worst:?}", m.name);
    }
}

#[test]
fn the_planes_of_the_table_are_found() {
    let worst = Match { name: "any", found: 0.8, pure: 0.9, angle: 0.01, offset: 0.005 };
    for preset in PRESETS {
        for seed in 0..3 {
            let (made, map) = scanned(&Scene::table(), preset(), 30_000, seed);
            check(&made, &map, 1_000, &worst, &[]);
        }
    }
}

#[test]
fn the_large_planes_of_the_room_are_found() {
    // The ceiling, seen from far below, is in parts.
    let regions = Match { name: "any", found: 0.97, pure: 0.97, angle: 0.001, offset: 0.001 };
    // In clusters the door 6 cm behind its wall is in the wall's plane, which costs 8 mm.
    let clusters = Match { name: "any", found: 0.45, pure: 0.8, angle: 0.01, offset: 0.01 };
    for seed in 0..2 {
        for (params, worst, parted) in
            [(Params::default(), &regions, &["ceiling"][..]), (Params::clusters(), &clusters, &[])]
        {
            let (made, map) = scanned(&Scene::room(), params, 300_000, seed);
            check(&made, &map, 20_000, worst, parted);
        }
    }
}

#[test]
fn the_large_planes_of_the_corridor_are_found() {
    let regions = Match { name: "any", found: 0.97, pure: 0.97, angle: 0.001, offset: 0.001 };
    // In clusters, doors in niches of 8 to 20 cm, less deep than a cell, and edges shared with other surfaces cost up to 2.5 cm.
    let clusters = Match { name: "any", found: 0.7, pure: 0.8, angle: 0.01, offset: 0.03 };
    for (params, worst) in [(Params::default(), &regions), (Params::clusters(), &clusters)] {
        let (made, map) = scanned(&Scene::corridor(), params, 400_000, 0);
        check(&made, &map, 20_000, worst, &[]);
    }
}
