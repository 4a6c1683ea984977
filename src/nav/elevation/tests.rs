use proptest::prelude::*;

use super::*;
use crate::geometry::{Aabb, Point, direction, math};
use crate::nav::graph::shortest_path;
use crate::nav::grid::PlanError;
use crate::random::Stream;
use crate::testing::reliefs;
use crate::world::generate::ReliefKind;
use crate::world::{GridCell, HeightField};

const CLIMBER: Climber = Climber { slope: 0.35, step: 0.02, radius: 0.15 };

fn square(side: f64) -> Aabb {
    Aabb::new(Point::origin(), Point::new(side, side))
}

fn rough(seed: u64, samples: usize) -> HeightField {
    let mut stream = Stream::new(seed);
    let waves: Vec<_> = (0..6)
        .map(|_| (direction(stream.between(0.0, 3.0)) * stream.between(1.0, 6.0), stream.between(0.0, 6.0)))
        .collect();
    let height =
        |at: Point| waves.iter().map(|(wave, phase)| 0.05 * math::sin(wave.dot(&at.coords) + phase)).sum();
    let side = 0.05 * (samples - 1) as f64;
    HeightField::from_fn(samples, samples, square(side), height).unwrap()
}

fn objectives() -> [Objective; 3] {
    [Objective::Length, Objective::Energy { resistance: 0.1 }, Objective::Time { speed: 0.3, climb: 0.05 }]
}

/// Dijkstra's algorithm on the graph of all steps, written down by itself.
fn dijkstra(map: &ElevationMap, objective: Objective, start: Point, goal: Point) -> Option<f64> {
    let (field, open) = (map.field(), map.open());
    let columns = field.columns();
    let [start, goal] = [start, goal].map(|end| {
        let cell = map.cell_at(end).unwrap();
        cell.row * columns + cell.column
    });
    let free = |x: i64, y: i64| x >= 0 && y >= 0 && open.is_free(GridCell::new(x as usize, y as usize));
    let steps = |node: usize, visit: &mut dyn FnMut(usize, f64)| {
        let (x, y) = ((node % columns) as i64, (node / columns) as i64);
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            if (dx, dy) != (0, 0) && free(x, y) && free(x + dx, y) && free(x, y + dy) && free(x + dx, y + dy)
            {
                let next = GridCell::new((x + dx) as usize, (y + dy) as usize);
                let way = map.point(next) - map.point(GridCell::new(x as usize, y as usize));
                visit(next.row * columns + next.column, objective.of_stretch(way.xy().norm(), way.z));
            }
        }
    };
    let path = shortest_path(columns * field.rows(), start, goal, steps, |_| 0.0, |_| {});
    path.ok().map(|path| path.cost)
}

proptest! {
    #![proptest_config(crate::testing::cases(48))]
    #[test]
    fn all_find_what_dijkstra_finds(seed in any::<u64>(), ends in [0.3..1.7f64, 0.3..1.7f64, 0.3..1.7f64, 0.3..1.7f64]) {
        let field = rough(seed, 41);
        let map = ElevationMap::new(&field, &CLIMBER).unwrap();
        let (start, goal) = (Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3]));
        for objective in objectives() {
            let plan = |planner: Result<ElevationPlanner<'_>, _>| planner.unwrap().plan(start, goal);
            let (a, b) = (plan(ElevationPlanner::astar(&map, objective)), plan(ElevationPlanner::dijkstra(&map, objective)));
            let expected = dijkstra(&map, objective, start, goal);
            match (a, b, expected) {
                (Ok(a), Ok(b), Some(expected)) => {
                    prop_assert_eq!(a.cost, b.cost);
                    prop_assert!((a.cost - expected).abs() <= 1e-4 * expected, "{} for {}", a.cost, expected);
                    let any = ElevationPlanner::astar(&map, objective).unwrap().plan_any_angle(start, goal).unwrap();
                    prop_assert!(any.cost <= a.cost * (1.0 + 1e-4) + 1e-12, "{} for {}", any.cost, a.cost);
                }
                (Err(a), Err(b), None) => prop_assert_eq!(a, b),
                (Err(a), Err(b), Some(0.0)) => prop_assert_eq!(a, b),
                other => prop_assert!(false, "{:?}", other),
            }
        }
    }

    /// What goes up comes down: for energy, the ways there and back differ by the rise alone.
    #[test]
    fn uphill_is_dearer_by_the_rise(seed in any::<u64>(), ends in [0.3..1.7f64, 0.3..1.7f64, 0.3..1.7f64, 0.3..1.7f64]) {
        let map = ElevationMap::new(&rough(seed, 41), &CLIMBER).unwrap();
        let (start, goal) = (Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3]));
        let mut planner = ElevationPlanner::astar(&map, Objective::Energy { resistance: 0.2 }).unwrap();
        if let (Ok(there), Ok(back)) = (planner.plan(start, goal), planner.plan(goal, start)) {
            let rise = there.points[there.points.len() - 1].z - there.points[0].z;
            let error = 1e-4 * (there.cost + back.cost) + 1e-9;
            prop_assert!((there.cost - back.cost - rise).abs() <= error, "{} {} {}", there.cost, back.cost, rise);
        }
    }

    #[test]
    fn a_plane_is_open_or_closed_as_its_slope_says(degrees in 1.0..40.0f64, heading in -3.0..3.0f64) {
        let rise = direction(heading) * math::tan(degrees.to_radians());
        let plane = HeightField::from_fn(41, 31, square(2.0), |at| rise.dot(&at.coords)).unwrap();
        let map = ElevationMap::new(&plane, &CLIMBER).unwrap();
        let gentle = degrees.to_radians() < CLIMBER.slope;
        prop_assume!((degrees.to_radians() - CLIMBER.slope).abs() > 1e-3);
        prop_assert_eq!(map.open().is_free(GridCell::new(20, 15)), gentle);
        prop_assert!(!map.open().is_free(GridCell::new(1, 15)), "it would reach beyond");
    }

    /// A steeper limit never makes the highest place lower, and the place is on an open way from the start.
    #[test]
    fn who_climbs_more_comes_higher(range in reliefs(ReliefKind::Range)) {
        let ground = range.world.terrain.unwrap().surface.unwrap();
        let start = range.start.position();
        let mut before = f64::NEG_INFINITY;
        for slope in [0.2, 0.3, 0.4, 0.8] {
            let map = ElevationMap::new(&ground, &CLIMBER.with_slope(slope)).unwrap();
            let Some(top) = map.highest_reachable(start) else { continue };
            prop_assert!(top.z >= before);
            before = top.z;
            let way = ElevationPlanner::astar(&map, Objective::Length).unwrap().plan(start, top.xy());
            prop_assert!(way.is_ok(), "{:?}", way);
        }
        prop_assert!(before > 0.0, "nowhere to stand");
    }
}

/// D* Lite and its map after each of a thousand changes are what a fresh plan on a fresh map is.
#[test]
fn a_thousand_changes_are_planned_as_anew() {
    // A small robot, so that changes do not close everything.
    let climber = Climber { radius: 0.05, ..CLIMBER };
    let (mut answers, mut stream) = ([0, 0], Stream::new(7));
    for round in 0..10 {
        let field = rough(round, 33);
        let objective = objectives()[round as usize % 3];
        // Half of the maps have water.
        let lowest = if round % 2 == 0 { -0.06 } else { f64::NEG_INFINITY };
        let (start, goal) = (Point::new(0.3, 0.3), Point::new(1.3, 1.2));
        let map = ElevationMap::new(&field, &climber).unwrap().above(lowest).unwrap();
        let mut kept = ElevationReplanner::new(map, objective, start, goal).unwrap();
        let mut heights: Vec<f32> = (0..33 * 33).map(|i| field.sample(i % 33, i / 33) as f32).collect();
        let mut robot = start;
        for _ in 0..100 {
            let cell = GridCell::new(stream.below(33), stream.below(33));
            let height = field.sample(cell.column, cell.row) + stream.between(-0.03, 0.03);
            kept.set_height(cell, height).unwrap();
            heights[cell.row * 33 + cell.column] = height as f32;
            let changed = HeightField::new(33, 33, field.area(), heights.clone()).unwrap();
            let map = ElevationMap::new(&changed, &climber).unwrap().above(lowest).unwrap();
            assert_eq!(kept.open(), map.open());
            let fresh = ElevationPlanner::astar(&map, objective).unwrap().plan(robot, goal);
            match (kept.plan(), fresh) {
                (Ok(kept), Ok(fresh)) => {
                    assert_eq!(kept.cost, fresh.cost);
                    answers[0] += 1;
                    if stream.chance(0.2) {
                        robot = kept.points[1.min(kept.points.len() - 1)].xy();
                    }
                }
                (Err(kept), Err(fresh)) => {
                    assert_eq!(kept, fresh);
                    answers[1] += 1;
                }
                other => panic!("{other:?}"),
            }
            kept.move_to(robot).unwrap();
        }
    }
    assert!(answers[0] > 300 && answers[1] > 50, "{answers:?}");
}

#[test]
fn on_level_ground_ways_in_any_direction_are_straight() {
    let level = HeightField::from_fn(61, 61, square(3.0), |_| 0.4).unwrap();
    let map = ElevationMap::new(&level, &CLIMBER).unwrap();
    let mut planner = ElevationPlanner::astar(&map, Objective::Length).unwrap();
    let (start, goal) = (Point::new(0.3, 0.4), Point::new(2.6, 1.1));
    let path = planner.plan_any_angle(start, goal).unwrap();
    assert!(path.points.len() == 2 && (path.cost - (goal - start).norm()).abs() < 1e-9, "{path:?}");
    assert!(planner.plan(start, goal).unwrap().cost > path.cost + 0.05);
}

#[test]
fn what_cannot_be_planned_is_told() {
    let level = HeightField::from_fn(21, 21, square(1.0), |_| 0.0).unwrap();
    let map = ElevationMap::new(&level, &CLIMBER).unwrap();
    let mut planner = ElevationPlanner::astar(&map, Objective::Length).unwrap();
    let (middle, out, edge) = (Point::new(0.5, 0.5), Point::new(0.5, 1.5), Point::new(0.02, 0.5));
    assert!(matches!(planner.plan(middle, out), Err(PlanError::Outside { .. })));
    assert!(matches!(planner.plan(out, middle), Err(PlanError::Outside { .. })));
    assert!(matches!(planner.plan(Point::new(f64::NAN, 0.0), middle), Err(PlanError::Outside { .. })));
    assert!(matches!(planner.plan(edge, middle), Err(PlanError::Blocked { .. })));
    assert_eq!(map.highest_reachable(out), None);
    assert!(map.clone().above(f64::NAN).is_err());
    assert_eq!(map.clone().above(0.1).unwrap().highest_reachable(middle), None);
    for objective in [
        Objective::Energy { resistance: 0.0 },
        Objective::Time { speed: f64::NAN, climb: 1.0 },
        Objective::Time { speed: 1.0, climb: -1.0 },
    ] {
        assert!(ElevationPlanner::astar(&map, objective).is_err());
        assert!(ElevationReplanner::new(map.clone(), objective, middle, middle).is_err());
    }
    for climber in [
        CLIMBER.with_slope(0.0),
        CLIMBER.with_slope(2.0),
        Climber { step: -1.0, ..CLIMBER },
        Climber { radius: 0.0, ..CLIMBER },
    ] {
        assert!(ElevationMap::new(&level, &climber).is_err());
    }
    let mut kept = ElevationReplanner::new(map.clone(), Objective::Length, middle, middle).unwrap();
    assert!(kept.set_height(GridCell::new(21, 0), 0.0).is_err());
    assert!(kept.set_height(GridCell::new(0, 0), f64::INFINITY).is_err());
    assert!(kept.move_to(out).is_err());
    assert!(ElevationReplanner::new(map, Objective::Length, middle, out).is_err());
    // A robot larger than the world has no place on it.
    let large = ElevationMap::new(&level, &Climber { radius: 5.0, ..CLIMBER }).unwrap();
    assert_eq!(large.open().count_free(), 0);
}
