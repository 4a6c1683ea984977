use super::*;
use crate::geometry::{Pose, direction};
use crate::world::{Object, ObjectKind, Wall};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Radius of the robot (m).
const RADIUS: f64 = 0.06;

fn point() -> impl Strategy<Value = Point> {
    (0.0..1.5, 0.0..1.5).prop_map(|(x, y)| Point::new(x, y))
}

fn scattered_world() -> impl Strategy<Value = World> {
    proptest::collection::vec((point(), point()), 0..8).prop_map(|ends| {
        let mut world = World::walled(1.5, 1.5);
        world.walls.extend(ends.into_iter().map(|(a, b)| Wall::new(a, b)));
        world
    })
}

/// A field in two halves, with a gap of this width in the wall between them.
fn gate(width: f64, angle: f64) -> (World, Point, Point) {
    let along = direction(angle);
    let middle = Point::new(1.0, 1.0);
    let mut world = World::walled(2.0, 2.0);
    for side in [-1.0, 1.0] {
        let post = middle + along * (side * 0.5 * width);
        world.walls.push(Wall { thickness: 0.0, ..Wall::new(post, middle + along * (side * 1.5)) });
    }
    let across = direction(angle + 0.25 * TAU) * 0.4;
    (world, middle + across, middle - across)
}

fn ring(middle: Point, radius: f64, corners: usize) -> Vec<Point> {
    (0..corners).map(|i| middle + direction(TAU * i as f64 / corners as f64) * radius).collect()
}

/// Two robots on one raster. Separate rasters would begin elsewhere for each radius and shift the cells'
/// centres.
fn on_the_same_cells(world: &World, small: f64, large: f64) -> (Reachability, Reachability) {
    let field = Clearance::new(world, 0.02, large.next_up()).unwrap();
    (Reachability::from_clearance(&field, small), Reachability::from_clearance(&field, large))
}

#[test]
fn where_a_little_larger_robot_is_free_a_smaller_one_is_on_the_same_cells() {
    let mut world = World::walled(1.5, 1.5);
    let (a, b) = (
        Point::new(1.295_353_739_462_582, 1.302_823_508_322_175_3),
        Point::new(0.227_983_789_037_898_76, 0.491_513_279_303_407_6),
    );
    world.walls.push(Wall::new(a, b));
    let (point, large) =
        (Point::new(1.009_324_555_896_596_6, 1.003_882_048_723_805_6), RADIUS + 0.008_120_689_208_133_025);
    let own = [RADIUS, large].map(|radius| Reachability::new(&world, radius, 0.02).unwrap().is_free(point));
    assert_eq!(own, [false, true]);
    let (small, large) = on_the_same_cells(&world, RADIUS, large);
    assert_eq!([small, large].map(|space| space.is_free(point)), [true, true]);
}

proptest! {
    #![proptest_config(crate::testing::cases(24))]

    #[test]
    fn connection_and_length_are_symmetric(world in scattered_world(), a in point(), b in point()) {
        let space = Reachability::new(&world, RADIUS, 0.02).unwrap();
        prop_assert_eq!(space.connected(a, b), space.connected(b, a));
        match (space.shortest_path_length(a, b), space.shortest_path_length(b, a)) {
            (Some(there), Some(back)) => {
                prop_assert!(space.connected(a, b));
                // On ways of equal cost the pieces between the given points and the cells' centres may
                // differ.
                prop_assert!((there - back).abs() < 0.03, "{} {}", there, back);
                prop_assert!(there >= (b - a).norm() - 1e-9);
            }
            (there, back) => prop_assert!(there.is_none() && back.is_none() && !space.connected(a, b)),
        }
    }

    #[test]
    fn a_larger_robot_reaches_no_more(world in scattered_world(), a in point(), b in point(), more in 0.0..0.1) {
        let (small, large) = on_the_same_cells(&world, RADIUS, RADIUS + more);
        prop_assert!(small.is_free(a) || !large.is_free(a));
        prop_assert!(small.connected(a, b) || !large.connected(a, b));
    }

    #[test]
    fn a_way_stays_in_free_cells_and_takes_one_step_at_a_time(
        world in scattered_world(), a in point(), b in point(),
    ) {
        let space = Reachability::new(&world, RADIUS, 0.02).unwrap();
        if let Some(path) = space.shortest_path(a, b) {
            prop_assert!(path.points.iter().all(|&p| space.is_free(p)));
            let inner = &path.points[1..path.points.len() - 1];
            prop_assert!(inner.windows(2).all(|w| (w[1] - w[0]).norm() < 0.02 * SQRT_2 + 1e-9));
        }
    }

    #[test]
    fn the_way_is_as_short_as_relaxing_all_steps_finds(
        world in scattered_world(), a in point(), b in point(),
    ) {
        let space = Reachability::new(&world, RADIUS, 0.05).unwrap();
        if let Some(path) = space.shortest_path(a, b) {
            let (start, goal) = (space.raster.cell_at(a).unwrap(), space.raster.cell_at(b).unwrap());
            let mut search = Search::new(&space, goal);
            prop_assert!(search.run(start));
            prop_assert!((search.costs[goal] - bellman_ford(&space, start)[goal]).abs() < 1e-9);
            prop_assert!(path.expanded <= space.region_size(a));
        }
    }

    #[test]
    fn a_gap_connects_from_the_robots_width_on(angle in 0.0..TAU, resolution in 0.004..0.01) {
        let (world, a, b) = gate(2.0 * RADIUS + 1.5 * resolution, angle);
        prop_assert!(Reachability::new(&world, RADIUS, resolution).unwrap().connected(a, b));
        let (world, a, b) = gate(2.0 * RADIUS - resolution, angle);
        prop_assert!(!Reachability::new(&world, RADIUS, resolution).unwrap().connected(a, b));
    }

    #[test]
    fn a_closed_ring_disconnects_and_an_open_one_does_not(corners in 3usize..40, opening in 0usize..3) {
        let middle = Point::new(1.0, 1.0);
        let mut world = World::walled(2.0, 2.0);
        world.add_loop(&ring(middle, 0.6, corners));
        let corner = Point::new(0.2, 0.2);
        let closed = Reachability::new(&world, RADIUS, 0.01).unwrap();
        prop_assert!(closed.is_free(middle) && closed.is_free(corner) && !closed.connected(middle, corner));
        // Removes walls until the gap is twice as wide as the robot.
        let side = world.walls[5].line.length();
        let gone = (4.0 * RADIUS / side).ceil() as usize;
        world.walls.drain(4 + opening.min(corners - gone)..).take(gone).for_each(drop);
        let open = Reachability::new(&world, RADIUS, 0.01).unwrap();
        prop_assert!(open.connected(middle, corner));
    }
}

/// Costs of all cells, by relaxing every step until nothing changes.
fn bellman_ford(space: &Reachability, start: usize) -> Vec<f64> {
    let mut costs = vec![f64::INFINITY; space.raster.cells()];
    costs[start] = 0.0;
    let mut changed = true;
    while changed {
        changed = false;
        for cell in (0..costs.len()).filter(|&cell| space.is_free_cell(cell)) {
            let cost = costs[cell];
            space.steps(cell, |next, diagonal| {
                let better = cost + if diagonal { SQRT_2 } else { 1.0 };
                if better + 1e-12 < costs[next] {
                    costs[next] = better;
                    changed = true;
                }
            });
        }
    }
    costs
}

#[test]
fn objects_block_as_walls_do() {
    let mut world = World::walled(2.0, 0.2);
    let (a, b) = (Point::new(0.3, 0.1), Point::new(1.7, 0.1));
    assert!(Reachability::new(&world, RADIUS, 0.005).unwrap().connected(a, b));
    let can = Arc::new(ObjectKind::predefined("can").unwrap());
    world.objects.push(Object::new(can, Pose::new(1.0, 0.1, 0.0)));
    assert!(!Reachability::new(&world, RADIUS, 0.005).unwrap().connected(a, b));
}

#[test]
fn places_in_walls_and_outside_are_not_free() {
    let space = Reachability::new(&World::walled(1.0, 1.0), RADIUS, 0.005).unwrap();
    assert!(space.is_free(Point::new(0.5, 0.5)));
    assert!(!space.is_free(Point::new(0.5, 0.01)));
    assert!(!space.is_free(Point::new(50.0, 0.5)));
    assert!(!space.is_free(Point::new(f64::NAN, 0.5)));
    assert_eq!(space.shortest_path(Point::new(0.5, 0.5), Point::new(50.0, 0.5)), None);
    assert_eq!(space.region_size(Point::new(0.5, 0.01)), 0);
}

#[test]
fn nonsense_is_refused() {
    let world = World::walled(1.0, 1.0);
    let error = Reachability::new(&world, -0.1, 0.005).unwrap_err();
    assert_eq!(error.to_string(), "robot radius is -0.1; expected a positive, finite number");
    assert!(Reachability::new(&world, f64::NAN, 0.005).is_err());
    assert!(Reachability::new(&world, 0.06, 0.0).is_err());
}

#[test]
fn a_way_to_the_same_place_has_no_length() {
    let space = Reachability::new(&World::walled(1.0, 1.0), RADIUS, 0.005).unwrap();
    let here = Point::new(0.5, 0.5);
    assert_eq!(space.shortest_path_length(here, here), Some(0.0));
}
