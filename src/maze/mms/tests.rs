use proptest::prelude::*;

use super::*;
use crate::maze::generate::{competition, mazes};
use crate::maze::{Cell, Direction, ExplorationOutcome, Maze, Unknown, WallState, distances_from_start};

/// Runs our mouse against our referee. `interrupt` presses the reset button after that number of lines.
fn play(maze: Maze, interrupt: Option<u64>) -> (MmsReferee, MmsMouse, ExplorationOutcome) {
    let mut referee = MmsReferee::new(maze);
    let mut mouse = MmsMouse::new();
    let mut answer = None;
    for line in 0.. {
        assert!(line < 2_000_000, "the mouse does not finish");
        if interrupt == Some(line) {
            referee.press_reset();
        }
        match mouse.step(answer.as_deref()).unwrap() {
            Move::Say(line) => {
                answer = referee.answer(&line);
                assert_eq!(answer.is_some(), mouse.awaits(), "{line}");
            }
            Move::Done(verdict) => return (referee, mouse, verdict),
        }
    }
    unreachable!()
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn our_mouse_proves_and_drives_the_shortest_way(truth in mazes(10), interrupt in prop::option::of(0u64..400)) {
        let mut truth = truth;
        truth.set_start(Cell::default(), Direction::North);
        truth.set_goals(truth.centre());
        let from_start = distances_from_start(&truth, Unknown::Closed);
        let shortest = truth.goals().filter_map(|goal| from_start.get(goal)).min();
        let (referee, mouse, verdict) = play(truth.clone(), interrupt);
        prop_assert_eq!(verdict, if shortest.is_some() { ExplorationOutcome::Optimal } else { ExplorationOutcome::Unreachable });
        prop_assert_eq!(referee.ignored(), (0, None));
        let known = mouse.maze().unwrap();
        for cell in truth.cells() {
            for side in Direction::ALL {
                let wall = known.wall(cell, side);
                prop_assert!(wall == WallState::Unknown || wall == truth.wall(cell, side));
            }
        }
        if shortest.is_some_and(|steps| steps > 0) {
            prop_assert!(referee.score().solved && truth.is_goal(referee.at().0));
            let best = referee.score().best.unwrap();
            prop_assert!(best.distance >= shortest.unwrap());
            prop_assert!(referee.score().value() < 2000.0);
        }
    }

    #[test]
    fn a_referee_takes_any_line(lines in prop::collection::vec("[ -~]{0,40}|moveForward [0-9]{1,12}|wallFront [0-9]{1,12}|set(WallState|Text|Color) -?[0-9]{1,9} [0-9]{1,3} [a-z]", 0..60)) {
        let mut referee = MmsReferee::new(competition(8, 1).unwrap());
        for line in &lines {
            referee.answer(line);
        }
        prop_assert!(referee.commands() + referee.ignored().0 == lines.len() as u64);
    }
}

#[test]
fn the_referee_answers_as_the_simulator_does() {
    let mut maze = Maze::open(3, 4).unwrap();
    maze.set_wall(Cell::new(0, 2), Direction::North, WallState::Present);
    maze.set_goals([Cell::new(1, 2)]);
    let mut referee = MmsReferee::new(maze);
    let dialogue = [
        ("mazeWidth", Some("3")),
        ("mazeHeight", Some("4")),
        ("wallFront", Some("false")),
        ("wallLeft", Some("true")),
        ("wallBack", Some("true")),
        ("wallFront 5", Some("true")),
        ("wallFront 2", None),
        ("setWall 0 0 w", None),
        ("setWall 0 0 up", None),
        ("setText 0 0 here", None),
        ("getStat score", Some("2000")),
        ("getStat best-run-turns", Some("-1")),
        ("moveForward 3", Some("crash")),
        ("getStat total-distance", Some("2")),
        ("moveForward", Some("crash")),
        ("turnRight", Some("ack")),
        ("wallFront", Some("false")),
        ("moveForward", Some("ack")),
        // 3 cells and a turn, plus a tenth of that.
        ("getStat score", Some("4.4")),
        ("wasReset", Some("false")),
        ("ackReset", Some("ack")),
        ("moveForward 2", Some("ack")),
        ("getStat current-run-effective-distance", Some("17")),
        ("turnAround", None),
    ];
    for (line, answer) in dialogue {
        assert_eq!(referee.answer(line).as_deref(), answer, "{line}");
    }
    assert_eq!(referee.ignored(), (3, Some("wallFront 2")));
    assert_eq!(referee.score().best.map(|run| (run.distance, run.turns)), Some((3, 1)));
}

#[test]
fn long_straights_count_by_half() {
    let mut maze = Maze::open(1, 9).unwrap();
    maze.set_goals([Cell::new(0, 8)]);
    let mut referee = MmsReferee::new(maze);
    assert_eq!(referee.answer("moveForward 8").as_deref(), Some("ack"));
    assert_eq!(referee.score().best.map(|run| run.effective), Some(5.0));
    assert!((referee.score().value() - 5.5).abs() < 1e-12);
}

#[test]
fn answers_that_make_no_sense_are_named() {
    let mut mouse = MmsMouse::new();
    assert_eq!(mouse.step(None), Ok(Move::Say("mazeWidth".into())));
    let error = mouse.step(Some("-7")).unwrap_err();
    assert_eq!(error.to_string(), "found the answer \"-7\" to mazeWidth; expected 1 to 256");
    for (answer, expected) in [("maybe", "true or false"), ("", "true or false")] {
        let mut mouse = MmsMouse::new();
        for size in [None, Some("16"), Some("16")] {
            mouse.step(size).unwrap();
        }
        assert!(mouse.step(Some(answer)).unwrap_err().to_string().ends_with(expected));
    }
    let mut mouse = MmsMouse::new();
    mouse.step(None).unwrap();
    assert!(mouse.step(None).unwrap_err().to_string().contains("\"nothing\""));
}
