//! A grid map, or a scenario file; and what a small map is planned on.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::nav::grid::{AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PreparedJumps};
use roverlab::world::formats::movingai;

fuzz_target!(|text: &str| {
    if let Ok(parsed) = movingai::parse_scenarios(text, "fuzz.scen") {
        let again = movingai::parse_scenarios(&movingai::print_scenarios(&parsed.value), "fuzz.scen");
        assert_eq!(again.expect("the writer's scenarios read").value, parsed.value);
    }
    let Ok(parsed) = movingai::parse_map(text, "fuzz.map") else { return };
    let again = movingai::parse_map(&movingai::print_map(&parsed.value), "fuzz.map");
    assert_eq!(again.expect("the writer's map reads").value, parsed.value);
    let grid = parsed.value.grid();
    let cells: Vec<_> = grid.free_cells().take(1 << 10).collect();
    let (Some(&start), Some(&goal)) = (cells.first(), cells.last()) else { return };
    let expected = GridSearch::astar(&grid).plan(start, goal).map(|path| path.cost);
    for planner in [&mut JumpPointSearch::new(&grid) as &mut dyn GridPlanner, &mut PreparedJumps::new(&grid)] {
        assert_eq!(planner.plan(start, goal).map(|path| path.cost), expected);
    }
    let any_angle = AnyAngle::new(&grid).plan(start, goal).map(|path| path.cost);
    match (any_angle, expected) {
        (Ok(cost), Ok(octile)) => assert!(cost <= octile + 1e-9),
        (found, expected) => assert_eq!(found, expected),
    }
});
