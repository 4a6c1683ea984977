use super::*;
use crate::geometry::Vector;
use crate::world::{Colour, Texture, Water, Waves};
use proptest::prelude::*;

fn world(text: &str) -> World {
    parse(text, "test.wld").unwrap().value
}

fn near(point: Point, x: f64, y: f64) -> bool {
    (point - Point::new(x, y)).norm() < 1e-12
}

#[test]
fn a_second_line_of_its_kind_is_warned_of() {
    let parsed = parse("floor 1000 1000\nposition 1 2 3\nposition 4 5 6", "test.wld").unwrap();
    assert!(parsed.warnings[0].to_string().starts_with("test.wld:3:1: a second `position`"));
}

#[test]
fn all_keywords() {
    let text = "; a world\r\nFloor 5000 4000\r\nfloor_texture \"my floor.png\"\r\n\
                0 0 5000 0\n\t0 0 0 4000 20 500 ; thick 1\n0 1 2 3 10 200 255 0 128\n\
                position 100 200 90\nwater_level 150\nterrain 6000 7000 300 ../h/crater.png";
    let Parsed { value, warnings } = parse(text, "test.wld").unwrap();
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(value.floor.max, Point::new(6.0, 7.0));
    assert_eq!(value.floor_texture, Some("my floor.png".into()));
    assert_eq!(value.walls[0], Wall::new(Point::new(0.0, 0.0), Point::new(5.0, 0.0)));
    assert_eq!((value.walls[1].thickness, value.walls[1].height), (0.02, 0.5));
    assert_eq!(value.walls[2].colour, Colour::new(255, 0, 128));
    assert_eq!(value.start, Some(Pose::from_mm_deg(100.0, 200.0, 90.0)));
    assert_eq!(value.water_level, Some(0.15));
    assert_eq!(value.terrain.unwrap().max_elevation, 0.3);
}

#[test]
fn push_turns_clockwise_and_nests() {
    let world = world(
        "floor 9000 9000\npush 1000 2000 90\n0 0 500 0\npush 100 0 90\n0 0 500 0\npop\n0 0 0 1\npop\npop\n0 0 1 0",
    );
    let lines: Vec<Segment> = world.walls.iter().map(|w| w.line).collect();
    assert!(near(lines[0].a, 1.0, 2.0) && near(lines[0].b, 1.0, 1.5), "{:?}", lines[0]);
    assert!(near(lines[1].a, 1.0, 1.9) && near(lines[1].b, 0.5, 1.9), "{:?}", lines[1]);
    assert!(near(lines[2].b, 1.001, 2.0), "{:?}", lines[2]);
    assert!(near(lines[3].b, 0.001, 0.0), "{:?}", lines[3]);
}

/// A door of width 1305 turned by `push … 90` fills the gap from 6390 down to 5085, not up from 6390.
#[test]
fn a_pushed_door_closes_its_gap() {
    let line = world("push 22280 6390 90\n0 0 1305 0").walls[0].line;
    assert!(near(line.a, 22.28, 6.39) && near(line.b, 22.28, 5.085));
}

#[test]
fn odd_lines_are_skipped_with_their_place() {
    let text = "floor 100 100\nush 1 2 3\n5000 0 0\n0 0 1 1 7 ; five\nball 3 4\npop 1\n0 0 9 0 1 0";
    let parsed = parse(text, "w.wld").unwrap();
    let messages: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "w.wld:2:1: unknown keyword `ush`; the line is skipped",
            "w.wld:3:1: a wall of 3 numbers, not 4, 6 or 9; skipped",
            "w.wld:4:9: a wall of 5 numbers, not 4, 6 or 9; only the first 4 count",
            "w.wld:5:1: unknown keyword `ball`; the line is skipped",
            "w.wld:6:5: `1` is more than belongs in this line; ignored",
            "w.wld:7:1: a wall of height 0; skipped",
        ]
    );
    assert_eq!(parsed.value.walls.len(), 1);
}

#[test]
fn without_a_floor_it_reaches_as_far_as_the_walls() {
    assert_eq!(world("-500 0 3000 0\n0 0 0 2000").floor.max, Point::new(3.0, 2.0));
    assert_eq!(world("width 100\n0 0 0 2000").floor.max, Point::new(0.1, 2.0));
    assert_eq!(world("").floor.max, Point::origin());
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![(-1e6..1e6f64), (-9999..9999i32).prop_map(|mm| f64::from(mm) / 1000.0)]
}

fn path() -> impl Strategy<Value = Texture> {
    "[a-z\\\\ ./$#;']{1,12}".prop_map(|file| Texture::from(file.as_str()))
}

fn wall() -> impl Strategy<Value = Wall> {
    let ends = (length(), length(), length(), length());
    let body = prop_oneof![Just((0.01, 0.2)), (0.0..1.0f64, 1e-3..9.0f64)];
    let colour =
        prop_oneof![Just(Colour::WHITE), any::<[u8; 3]>().prop_map(|[r, g, b]| Colour::new(r, g, b))];
    (ends, body, colour).prop_map(|((ax, ay, bx, by), (thickness, height), colour)| {
        let line = Segment::new(Point::new(ax, ay), Point::new(bx, by));
        Wall { line, thickness, height, colour }
    })
}

fn water() -> impl Strategy<Value = Water> {
    let speed = || (-9999..9999i32, -9999..9999i32);
    let waves = proptest::option::of((0..99i32, 50..300i32, -179..=180i32, any::<bool>()));
    let layers = proptest::collection::vec((1..5000i32, speed()), 0..4);
    let rest = (speed(), 0.0..2.0f64);
    (500.0..1500.0f64, layers, waves, rest).prop_map(|(density, layers, waves, (wind, turbidity))| {
        let vector = |(x, y): (i32, i32)| Vector::new(f64::from(x), f64::from(y)) / 1000.0;
        let mut depth = -1000;
        let layer = |(more, speed): (i32, (i32, i32))| {
            depth += more;
            (f64::from(depth) / 1000.0, vector(speed))
        };
        let waves = waves.map(|(height, period, degrees, irregular)| Waves {
            height: f64::from(height) / 1000.0,
            period: f64::from(period) / 10.0,
            direction: units::from_deg(f64::from(degrees)),
            irregular,
        });
        let current = layers.into_iter().map(layer).collect();
        Water { density, current, waves, wind: vector(wind), turbidity }
    })
}

prop_compose! {
    fn any_world()(
        floor in (0.0..1e6f64, 0.0..1e6f64),
        floor_texture in proptest::option::of(path()),
        walls in proptest::collection::vec(wall(), 0..8),
        start in proptest::option::of((length(), length(), -180..=180i32)),
        terrain in proptest::option::of((0.0..99.0f64, 0.0..99.0f64, length(), path())),
        water_level in proptest::option::of(length()),
        water in water(),
    ) -> World {
        World {
            floor_texture,
            walls,
            start: start.map(|(x, y, deg)| Pose::new(x, y, units::from_deg(f64::from(deg)))),
            terrain: terrain.map(|(width, height, max_elevation, path)| {
                Terrain { width, height, max_elevation, file: path.file, surface: None }
            }),
            water_level,
            water,
            ..World::empty(floor.0, floor.1)
        }
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_printed_reads_back(world in any_world()) {
        let parsed = parse(&print(&world), "w.wld").unwrap();
        prop_assert!(parsed.warnings.is_empty());
        prop_assert_eq!(parsed.value, world);
    }

    #[test]
    fn what_was_read_survives_printing(text in "((floor|push|pop|position|x|floor_texture| |\n|;|\"|-|[0-9.]{1,3}){1,6}\n){0,8}") {
        if let Ok(parsed) = parse(&text, "w.wld") {
            prop_assert_eq!(parse(&print(&parsed.value), "w.wld").unwrap().value, parsed.value);
        }
    }
}
