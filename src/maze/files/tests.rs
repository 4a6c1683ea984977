use proptest::prelude::*;

use super::*;
use crate::maze::generate::partly_known;
use crate::maze::{Cell, Direction, Preference, Unknown, WallState, shortest_route};

fn read(text: &str) -> MazeFile {
    parse(text.as_bytes(), "test").unwrap()
}

fn messages(file: &MazeFile) -> Vec<String> {
    file.defects.iter().map(ToString::to_string).collect()
}

/// The maze, reduced to what every format can express.
fn plain(maze: &Maze) -> Maze {
    let mut plain = Maze::open(maze.width(), maze.height()).unwrap();
    for cell in maze.cells() {
        for side in Direction::ALL {
            let present = maze.wall(cell, side) == WallState::Present;
            plain.set_wall(cell, side, if present { WallState::Present } else { WallState::Absent });
        }
    }
    plain
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_written_is_read_back(maze in partly_known(20)) {
        for format in [MazeFormat::Text, MazeFormat::Maze] {
            let mut maze = maze.clone();
            maze.set_start(maze.start(), Direction::North);
            prop_assume!(!maze.is_goal(maze.start()));
            let back = read(&print(&maze, format).unwrap());
            prop_assert_eq!(&back.maze, &maze);
            prop_assert_eq!(back.format, format);
        }
        for format in [MazeFormat::Map, MazeFormat::Num] {
            let back = read(&print(&maze, format).unwrap());
            prop_assert_eq!(&back.maze, &plain(&maze));
            prop_assert_eq!(back.format, format);
        }
        let mut lettered = plain(&maze);
        lettered.set_start(maze.start(), maze.heading());
        lettered.set_goals(maze.goals());
        let back = read(&print(&lettered, MazeFormat::EyeSim).unwrap());
        prop_assert_eq!(back.maze, lettered);
        prop_assert_eq!(back.format, MazeFormat::EyeSim);
    }

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&bytes, "noise");
    }

    #[test]
    fn no_broken_picture_makes_a_reader_panic(
        maze in partly_known(6),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), "[ |o+.SGx\n-]"), 1..8),
    ) {
        let mut text = print(&maze, MazeFormat::Text).unwrap();
        for (place, mark) in cuts {
            let at = place.index(text.len());
            text.replace_range(at..=at, &mark);
        }
        if let Ok(file) = parse(text.as_bytes(), "broken") {
            let _ = shortest_route(&file.maze, Unknown::Closed, Preference::Steps);
        }
    }
}

const SMALL: &str = "\
o---o---o---o
|     G |   |
o   o---o   o
| S         |
o---o---o---o
";

#[test]
fn the_text_format_has_marks_and_remarks() {
    let plain = read(SMALL);
    assert_eq!((plain.format, messages(&plain)), (MazeFormat::Text, vec![]));
    assert_eq!((plain.maze.width(), plain.maze.height()), (3, 2));
    assert_eq!(plain.maze.goals().collect::<Vec<_>>(), [Cell::new(1, 1)]);
    let remarked = format!("A maze of 1986, London\n\n{SMALL}\nText below: o---o and\n1 2 3 4 5 6\n");
    assert_eq!(read(&remarked).maze, plain.maze);
    assert_eq!(read(&SMALL.replace('\n', "\r\n")).maze, plain.maze);
    assert_eq!(read(&SMALL.replace('\n', "   \n")).maze, plain.maze);
    assert_eq!(read(&SMALL.replace('\n', "\n  ").replacen('o', "  o", 1)).maze, plain.maze);
    assert_eq!(read(&format!("\u{feff}{}", SMALL.trim_end())).maze, plain.maze);
    let latin = [SMALL.as_bytes(), b"M\xfcnchen\n"].concat();
    assert_eq!(parse(&latin, "latin").unwrap().maze, plain.maze);
    assert_eq!(read(&SMALL.replace(" S ", "   ")).maze, plain.maze);
}

#[test]
fn defects_of_pictures_are_named() {
    let broken = SMALL
        .replace("o   o---o   o", "o   x-- o   o")
        .replace(" S         |", " S   ?     !")
        .replace('G', " ");
    assert_eq!(
        messages(&read(&broken)),
        [
            "line 3: \"x\" instead of a post in column 5",
            "line 3: \"-- \" instead of a wall in column 6; taken as one",
            "line 4: \"!\" instead of a wall in column 13; taken as one",
            "line 4: \"?\" in cell 1,0 has no meaning; ignored",
            "no goal is marked; the centre is taken",
        ]
    );
    let open = SMALL.replace("|     G |   |", "| S   G |    ");
    assert_eq!(
        messages(&read(&open)),
        [
            "a second start at cell 0,0; ignored",
            "the outer wall has 1 gap to the east, the first at cell 2,1"
        ]
    );
}

/// A maze with walls in every line, to be damaged.
const LINES: [&str; 9] = [
    "o---o---o---o---o",
    "|       |       |",
    "o   o---o   o   o",
    "|   |     G |   |",
    "o   o   o---o   o",
    "|       |       |",
    "o   o---o   o   o",
    "| S             |",
    "o---o---o---o---o",
];

#[test]
fn damaged_pictures_are_read_whole() {
    let whole = read(&LINES.join("\n"));
    assert_eq!((messages(&whole), whole.maze.width(), whole.maze.height()), (vec![], 4, 4));
    let first = |with: &str, index: usize, count: usize| {
        let mut lines = LINES.to_vec();
        let put: Vec<&str> = if with == "-" { vec![] } else { vec![with] };
        lines.splice(index..index + count, put);
        let file = read(&lines.join("\n"));
        assert_eq!((file.maze.width(), file.maze.height()), (4, 4), "{lines:#?}");
        assert_eq!(file.maze.goals().collect::<Vec<_>>(), [Cell::new(2, 2)], "{lines:#?}");
        let same = file.maze == whole.maze;
        (same, messages(&file).swap_remove(0))
    };
    let unknown = "its walls are unknown";
    for (with, index, count, same, message) in [
        // Inserted lines.
        ("", 4, 0, true, "line 5: found a blank line; expected a line of posts; skipped".into()),
        ("# hi", 4, 0, true, "line 5: found \"# hi\"; expected a line of posts; skipped".into()),
        ("", 5, 0, true, "line 6: found a blank line; expected a line of cells; skipped".into()),
        // Damaged lines.
        (
            "x   x---x   o   o",
            2,
            1,
            true,
            "line 3: found \"x   x---x   o   o\"; expected a line of posts; read as one".into(),
        ),
        (
            "?????????????????",
            4,
            1,
            false,
            "line 5: found \"?????????????????\"; expected a line of posts; read as one".into(),
        ),
        ("", 4, 1, false, format!("line 5: found a blank line; expected a line of posts; {unknown}")),
        ("", 5, 1, false, format!("line 6: found a blank line; expected a line of cells; {unknown}")),
        // Lost lines.
        (
            "-",
            4,
            1,
            false,
            format!("line 5: found \"|       |       |\"; expected a line of posts; {unknown}"),
        ),
        (
            "-",
            5,
            1,
            false,
            format!("line 6: found \"o   o---o   o   o\"; expected a line of cells; {unknown}"),
        ),
        ("-", 8, 1, false, format!("line 9: found the end of the file; expected a line of posts; {unknown}")),
        (
            "-",
            0,
            1,
            false,
            format!("line 1: found \"|       |       |\"; expected a line of posts; {unknown}"),
        ),
        // The first and the last line.
        ("x---o---o---o---o", 0, 1, true, "line 1: \"x\" instead of a post in column 1".into()),
        (" ---o---o---o---o", 0, 1, true, "line 1: \" \" instead of a post in column 1".into()),
        ("o---o---o---o--- ", 0, 1, true, "line 1: \" \" instead of a post in column 17".into()),
        ("o---o---o---o", 0, 1, false, "line 1: \" \" instead of a post in column 17".into()),
        ("o---o", 0, 1, false, "line 1: found \"o---o\"; expected a line of posts; read as one".into()),
        ("o---o", 8, 1, false, "line 9: found \"o---o\"; expected a line of posts; read as one".into()),
    ] {
        assert_eq!(first(with, index, count), (same, message), "{with:?} for {count} at {index}");
    }
}

#[test]
fn a_top_line_that_stands_twice_is_left_out() {
    let file = read(&format!("{}\n{}", LINES[0], LINES.join("\n")));
    assert_eq!(file.maze, read(&LINES.join("\n")).maze);
    assert_eq!(file.defects.len(), 1);
    assert!(file.defects[0].to_string().starts_with("line 2: found \"o---o---o"), "{}", file.defects[0]);
}

#[test]
fn a_second_picture_is_named() {
    let whole = read(&LINES.join("\n"));
    for between in ["\n", "\n\n", "\nAnother:\n", "\n\nAnother\n\n"] {
        let file = read(&[LINES.join("\n"), LINES.join("\n")].join(between));
        assert_eq!(file.maze, whole.maze, "{between:?}");
        assert_eq!(file.defects.len(), 1, "{between:?}");
        assert!(file.defects[0].message.contains("outside of the picture; expected remarks; ignored"));
    }
    let shown = format!("{}{}", "So a maze is drawn.\n".repeat(40), LINES.join("\n"));
    assert_eq!(
        parse(shown.as_bytes(), "x").unwrap_err().to_string(),
        "x:41:1: found a picture of 9 lines among 40 of text; expected a file that is a maze"
    );
}

#[test]
fn unknown_walls_and_maps() {
    let file = read("+---+---+\n|   . G |\n+ . +   +\n| S |   |\n+---+---+\n");
    assert_eq!((file.format, file.maze.unknown_walls()), (MazeFormat::Maze, 2));
    assert_eq!(messages(&file), ["2 walls are unknown", "the goal cannot be reached"]);
    let map = read("+---+---+\n|       |\n+   +   +\n|   |   |\n+---+---+\n");
    assert_eq!((map.format, map.defects.len(), map.maze.goals().count()), (MazeFormat::Map, 0, 4));
}

#[test]
fn lists_of_numbers() {
    let list = "0 0 0 1 1 1\n0 1 1 0 0 1\n1 0 0 0 1 1\n1 1 1 1 0 0\n2 0 0 1 1 0\n2 1 1 1 0 1\n";
    let file = read(list);
    assert_eq!((file.format, messages(&file)), (MazeFormat::Num, vec![]));
    let picture = "+---+---+---+\n|       |   |\n+   +   +   +\n|   |       |\n+---+---+---+\n";
    assert_eq!(print(&file.maze, MazeFormat::Map).unwrap(), picture);
    let broken = list.replace("1 0 0 0 1 1", "1 0 0 0 1 0\nhello").replace("2 1 1 1 0 1", "2 0 0 2 1 0");
    assert_eq!(
        messages(&read(&broken)),
        [
            "line 4: \"hello\" is no line of a cell; ignored",
            "line 7: 2 instead of 0 or 1; taken as a wall",
            "line 7: another line for cell 2,0; this one counts",
            "1 of 6 cells have no line, the first is 2,1",
            "line 1: cell 0,0 has a wall to the east that its neighbour has not; taken as a wall",
        ]
    );
    let far = parse(b"0 256 0 0 0 0\n", "far.num").unwrap_err();
    assert_eq!(far.to_string(), "far.num:1:1: found cell 0,256; expected columns and rows from 0 to 255");
}

#[test]
fn most_lines_say_that_they_are_of_cells() {
    let list = "0 0 0 1 1 1\n0 1 1 0 0 1\n1 0 0 0 1 1\n1 1 1 1 0 0\n";
    for first in ["# a comment", "X Y N E S W", "0 0 1 1", "0 0 1.0 0 1 1", "0 0 0 1 1 1 # c"] {
        let file = read(&format!("{first}\n{list}"));
        assert_eq!((file.format, file.maze.cell_count()), (MazeFormat::Num, 4));
        assert_eq!(messages(&file)[0], format!("line 1: {first:?} is no line of a cell; ignored"));
    }
}

#[test]
fn mazes_of_eyesim() {
    let file = read(" _ _ _\n|  g| |\n| |_  |\n|S|_ _|\n720\n");
    assert_eq!((file.format, file.cell), (MazeFormat::EyeSim, Some(0.72)));
    assert_eq!((file.maze.start(), file.maze.heading()), (Cell::new(0, 0), Direction::North));
    assert_eq!(file.maze.goals().collect::<Vec<_>>(), [Cell::new(1, 2)]);
    assert_eq!(messages(&file), [""; 0]);
    let twice = read(" _ _ _\n|s g| |\n| |_ r|\n|S|_ _|\n720\n");
    assert_eq!(twice.maze.start(), Cell::new(0, 2));
    let starts = ["a second start at cell 0,0; ignored", "a second start at cell 2,1; ignored"];
    assert_eq!(messages(&twice), starts);
    let facing = read(" _ _\n|_ r|\n|_ _|\n");
    assert_eq!((facing.maze.start(), facing.maze.heading()), (Cell::new(1, 1), Direction::East));
    assert_eq!(messages(&facing), ["no goal is marked; the centre is taken"]);
}

#[test]
fn binary_mazes_are_squares_of_bytes() {
    let maze = plain(&read(&print(&Maze::open(16, 16).unwrap(), MazeFormat::Map).unwrap()).maze);
    let mut bytes = vec![0_u8; 256];
    for cell in maze.cells() {
        for side in Direction::ALL {
            if maze.wall(cell, side) == WallState::Present {
                bytes[usize::from(cell.x) * 16 + usize::from(cell.y)] |= 1 << side as u8;
            }
        }
    }
    let file = parse(&bytes, "old.maz").unwrap();
    assert_eq!((file.format, &file.maze), (MazeFormat::Binary, &maze));
    assert!(file.defects.is_empty());
    bytes[20] |= 1;
    let file = parse(&bytes, "old.maz").unwrap();
    let expected = "cell 1,4 has a wall to the north that its neighbour has not; taken as a wall";
    assert_eq!(messages(&file), [expected]);
}

#[test]
fn a_maze_without_any_wall_is_read_back() {
    let mut maze = Maze::open(3, 2).unwrap();
    for cell in maze.cells().collect::<Vec<_>>() {
        for side in [Direction::North, Direction::East, Direction::South, Direction::West] {
            maze.set_wall(cell, side, WallState::Absent);
        }
    }
    assert_eq!(read(&print(&maze, MazeFormat::EyeSim).unwrap()).maze, maze);
    let unseen = parse(b"; a page\n\x0b not a maze", "x").unwrap_err().to_string();
    assert!(unseen.contains("expected rows of a maze"), "{unseen}");
}

#[test]
fn what_is_no_maze_is_an_error() {
    for (bytes, expected) in [
        (&b""[..], "x:1:1: found no row of a maze; expected rows of `|`, `_`, letters and blanks"),
        (b"o---o\n", "x:1:1: found one line of posts; expected lines of cells and posts below it"),
        (
            b"# A maze?\n this is prose without one,\n and more of it\n",
            "x:2:1: found \"this is prose without one,\"; expected rows of a maze of `|`, `_`, letters and blanks",
        ),
        (
            b" a | table | of\n| words | and |\n",
            "x:1:1: found \"a | table | of\"; expected rows of a maze of `|`, `_`, letters and blanks",
        ),
        (b"PNG\0", "x:1:1: found bytes that are no text; expected a maze"),
    ] {
        assert_eq!(parse(bytes, "x").unwrap_err().to_string(), expected);
    }
    let wide = format!("o{0}\n|{1}\no{0}\n", "---o".repeat(257), "   |".repeat(257));
    let error = parse(wide.as_bytes(), "wide").unwrap_err().to_string();
    assert_eq!(error, "wide:1:1: found a width of 257 cells; expected 1 to 256 cells");
    assert!(load("/nowhere/at/all.maze").unwrap_err().to_string().contains("no such file"));
}

#[test]
fn what_may_be_seen_otherwise_is_named() {
    let named = |text: &str, message: &str| {
        let file = read(text);
        assert!(messages(&file).iter().any(|found| found.contains(message)), "{:?}", messages(&file));
        file
    };
    named("+---+---+\n| S\t  G |\n+---+---+\n", "line 2: a tab in column 4");
    let wide = "+---+---+---+\n| S   G     |\n+---+---+---+\n";
    let cut = named(
        &format!("{wide}| |\n{}", "+---+---+\n|       |\n".repeat(4)),
        "\"---+\" to the right of the maze",
    );
    assert_eq!(cut.maze.width(), 2);
    // A character takes one column, whatever its encoding.
    let odd = named("+---+---+\n| é   G |\n+   +---+\n| S     |\n+---+---+\n", "has no meaning");
    assert_eq!(odd.maze.goals().collect::<Vec<_>>(), [Cell::new(1, 1)]);
}

#[test]
fn long_texts_are_read_or_refused_at_once() {
    let posts = "+---+\n|   |\n".repeat(150_000);
    assert!(parse(posts.as_bytes(), "posts").unwrap_err().to_string().contains("a height of 150000 cells"));
    let long = vec![b' '; (LONGEST + 1) as usize];
    assert!(parse(&long, "long").unwrap_err().to_string().contains("at most 4 MiB"));
}
