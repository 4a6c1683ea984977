use super::*;
use crate::geometry::Segment;
use proptest::prelude::*;

fn world(text: &str) -> World {
    parse(text, "test.maz").unwrap().value
}

fn lines(world: &World) -> Vec<Segment> {
    world.walls.iter().map(|wall| wall.line).collect()
}

fn segment(ax: f64, ay: f64, bx: f64, by: f64) -> Segment {
    Segment::new(Point::new(ax, ay), Point::new(bx, by))
}

#[test]
fn a_box_of_two_cells() {
    let world = world(" _ _\n|_ _|\n1000\n");
    assert_eq!(world.floor.max, Point::new(2.0, 1.0));
    let expected = [
        segment(0.0, 0.0, 2.0, 0.0),
        segment(0.0, 1.0, 2.0, 1.0),
        segment(0.0, 0.0, 0.0, 1.0),
        segment(2.0, 0.0, 2.0, 1.0),
    ];
    assert_eq!(lines(&world), expected);
}

#[test]
fn letters_stand_in_cells_and_capitals_on_walls() {
    let world = world(" _ _ _\n|a|o x|\n|S b D|\n");
    let places: Vec<(char, f64, f64)> =
        world.places.iter().map(|p| (p.letter, p.position.x, p.position.y)).collect();
    assert_eq!(places, [('a', 0.18, 0.54), ('S', 0.18, 0.18), ('b', 0.54, 0.18), ('D', 2.5 * 0.36, 0.18)]);
    assert_eq!(world.start, Some(Pose::from_mm_deg(180.0, 180.0, 90.0)));
    assert_eq!(world.places[3].heading, Some(units::from_deg(-90.0)));
    let names: Vec<&str> = world.objects.iter().map(|o| o.kind.name.as_str()).collect();
    assert_eq!(names, ["golf", "crate"]);
    let bottom: Vec<Segment> = lines(&world).into_iter().filter(|s| s.a.y == 0.0 && s.b.y == 0.0).collect();
    assert_eq!(bottom, [segment(0.0, 0.0, 0.36, 0.0), segment(0.72, 0.0, 1.08, 0.0)]);
}

/// As in hand-drawn files: from some point on, a row is shifted by a column.
#[test]
fn bars_and_letters_count_in_any_column() {
    let bars = world(" _ _ _\n|  _ _|\n|_ __|\n1000\n");
    let right: Vec<Segment> = lines(&bars).into_iter().filter(|s| s.a.x == s.b.x && s.a.x > 0.0).collect();
    assert_eq!(right, [segment(3.0, 0.0, 3.0, 2.0)], "the edge goes all the way up");
    let letters = world(" _ _\n| S |\n|_ a|\n1000\n");
    let places: Vec<(char, Point)> = letters.places.iter().map(|p| (p.letter, p.position)).collect();
    assert_eq!(places, [('S', Point::new(0.5, 1.5)), ('a', Point::new(1.5, 0.5))]);
    assert!(letters.start.is_some(), "the robot starts in the cell before");
    assert!(lines(&letters).contains(&segment(0.0, 1.0, 1.0, 1.0)), "a capital stands on a wall");
}

#[test]
fn the_cell_size_stands_first_or_last_or_nowhere() {
    let cell = |text: &str| parse_maze(text, "test.maz").unwrap().value.cell;
    assert_eq!(cell("720\n _\n|_|"), 0.72);
    assert_eq!(cell(" _\r\n|_|\r\n180 ; small\r\n"), 0.18);
    assert_eq!(cell("# maze\n\n _\n|_|\n\n  # end\n"), 0.36);
    assert_eq!(cell(" _\n|_|\n   \n250\n\n"), 0.25);
    assert_eq!(parse_maze(" _\n|_|\n   \n", "m").unwrap().value.rows(), 1);
}

#[test]
fn what_does_not_belong_is_named() {
    let parsed = parse_maze("180\n _ _\n||7_|\nmaze\n|_ _|\n90\n|_ _|\n360", "m.maz").unwrap();
    let messages: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "m.maz:4:1: `maze` is no row of a maze; skipped",
            "m.maz:6:1: a number inside the picture; ignored",
            "m.maz:8:1: a second cell size; this one counts",
            "m.maz:3:3: `7` has no meaning here; ignored",
        ]
    );
    assert_eq!(parsed.value.cell, 0.36);
}

prop_compose! {
    fn maze()(columns in 1..6usize, rows in 0..6usize)(
        walls in proptest::collection::vec(any::<(bool, bool)>(), (columns + 1) * (rows + 1)),
        letters in proptest::collection::vec(proptest::option::of(proptest::char::range('a', 'z')), columns * rows),
        cell in 0.001..3.0f64,
        columns in Just(columns),
        rows in Just(rows),
    ) -> MazGrid {
        let mut maze = MazGrid::new(columns, rows, cell).unwrap();
        for (i, &(below, left)) in walls.iter().enumerate() {
            maze.set_wall_below(i % (columns + 1), i / (columns + 1), below);
            maze.set_wall_left(i % (columns + 1), i / (columns + 1), left);
        }
        for (i, &letter) in letters.iter().enumerate() {
            maze.set_letter(i % columns, i / columns, letter);
        }
        maze
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_printed_reads_back(maze in maze()) {
        let parsed = parse_maze(&print(&maze), "m.maz").unwrap();
        prop_assert_eq!(parsed.warnings, vec![]);
        prop_assert_eq!(parsed.value, maze);
    }

    #[test]
    fn what_was_read_survives_printing(text in "(([|_ .aS7\t]){0,6}\n){0,6}(360|0\\.5|-1|x)?\n?") {
        if let Ok(parsed) = parse_maze(&text, "m.maz") {
            prop_assert_eq!(parse_maze(&print(&parsed.value), "m.maz").unwrap().value, parsed.value);
        }
    }

    #[test]
    fn joined_walls_are_as_long_as_single_ones(maze in maze()) {
        let count = (0..=maze.rows())
            .flat_map(|row| (0..=maze.columns()).map(move |column| (column, row)))
            .map(|(c, r)| usize::from(maze.wall_below(c, r)) + usize::from(maze.wall_left(c, r)))
            .sum::<usize>();
        let length: f64 = maze.to_world().walls.iter().map(|wall| wall.line.length()).sum();
        prop_assert!((length - count as f64 * maze.cell).abs() < 1e-9);
    }
}
