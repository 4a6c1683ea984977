use std::sync::Arc;

use proptest::prelude::*;

use super::super::{FormatError, MemoryFiles, Parsed};
use super::{Position, SimFile, Statement, parse, parse_document, parse_tolerantly, print};
use crate::geometry::{Point, Pose, units};
use crate::world::{Colour, Marker, RobotSpec, Scene, Settings, World};

const MAZE: &str = " _ _ _\n|a|b a|\n|S _ A|\n360\n";

fn files() -> MemoryFiles {
    let files = [
        ("w.wld", "floor 3000 2000\n0 0 3000 0\n"),
        ("m.MAZ", MAZE),
        (r"..\robots\LidarBot.robi", "drive DIFFERENTIAL_DRIVE\nname Lidar-Bot\nwheel 54 3600 1100 45\n"),
        ("fake.robi", "drive OMNI_DRIVE\nname s4\nwheel 54 3600 1100 45\n"),
        ("10SpeedLimitSign.esObj", "box 0 50 0 100 100 20\n"),
        ("cone.esObj", "name Cone-O\nsphere 0 50 0 50\n"),
        ("broken.robi", "drive DIFFERENTIAL_DRIVE\nwheel 54 x\n"),
    ];
    MemoryFiles(files.into_iter().map(|(name, text)| (name.into(), text.as_bytes().to_vec())).collect())
}

fn read(text: &str) -> Result<Parsed<Scene>, FormatError> {
    parse(text, "test.sim", &mut files())
}

fn scene(text: &str) -> Scene {
    read(text).unwrap().value
}

fn failure(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

fn warnings(text: &str) -> Vec<String> {
    read(text).unwrap().warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn robots_objects_and_marks() {
    let text = "\u{feff}# script\r\nworld w.wld\r\nSETTINGS vis trace\r\nrobot ..\\robots\\LidarBot.robi\r\n\
                object 10SpeedLimitSign.esObj\r\nobj cone.esObj\r\n\r\n\
                s4 100 200 90 square.py ; the first 1 2 3\r\nlidar-bot 1 2 1000 -90 'my prog.x'\r\nLabbot 5 6 0\r\n\
                10speedlimitsign 7 8 192\r\nCone-O 9 10 0\r\ncan 300 600 45\r\n\
                marker 4500 4500 0 255 0\r\nmarker 1 2\r\nmarker 1 2 3 4 5 6";
    assert_eq!(warnings(text), Vec::<String>::new());
    let scene = scene(text);
    assert_eq!(scene.world.floor.max, Point::new(3.0, 2.0));
    assert_eq!(scene.settings, Settings { show_sensors: true, show_traces: true });
    let robots: Vec<_> = scene
        .robots
        .iter()
        .map(|r| (r.spec.name.as_str(), r.pose, r.elevation, r.program.as_deref()))
        .collect();
    assert_eq!(
        robots,
        [
            ("S4", Pose::from_mm_deg(100.0, 200.0, 90.0), 0.0, Some("square.py")),
            ("Lidar-Bot", Pose::from_mm_deg(1.0, 2.0, -90.0), 1.0, Some("my prog.x")),
            ("LabBot", Pose::from_mm_deg(5.0, 6.0, 0.0), 0.0, None),
        ]
    );
    let objects: Vec<_> = scene.world.objects.iter().map(|o| (o.kind.name.as_str(), o.pose.x)).collect();
    assert_eq!(objects, [("10SpeedLimitSign", 0.007), ("Cone-O", 0.009), ("can", 0.3)]);
    let marks: Vec<_> = scene.world.markers.iter().map(|m| (m.colour, m.alpha)).collect();
    assert_eq!(marks, [(Colour::GREEN, 255), (Colour::RED, 255), (Colour::new(3, 4, 5), 6)]);
}

#[test]
fn robots_stand_at_the_letters_of_a_maze() {
    let poses: Vec<Pose> = scene("S4 S 45 maze.x\nS4 s\nworld m.MAZ").robots.iter().map(|r| r.pose).collect();
    assert_eq!(poses, [Pose::from_mm_deg(180.0, 180.0, 45.0), Pose::from_mm_deg(180.0, 180.0, 90.0)]);
    let text = "world m.MAZ\nLabBot a simple.x\nS4 b -90";
    let found = scene(text);
    let places: Vec<(&str, f64, f64)> =
        found.robots.iter().map(|r| (r.spec.name.as_str(), r.pose.x, r.pose.y)).collect();
    let (left, right) = (0.5 * 0.36, 2.5 * 0.36);
    let (low, high) = (0.5 * 0.36, 1.5 * 0.36);
    assert_eq!(
        places,
        [("LabBot", left, high), ("LabBot", right, high), ("LabBot", right, low), ("S4", high, high)]
    );
    assert_eq!(found.robots[2].program.as_deref(), Some("simple.x"));
    assert_eq!(found, scene(text), "random headings are the same each time");
    assert_ne!(found.robots[0].pose.heading, found.robots[1].pose.heading);
    assert_eq!(warnings(text), ["test.sim:2:1: no heading; random ones are taken, the same each time"]);
    let other = parse_document(text, "t").unwrap().value.resolve("t", &mut files(), 7).unwrap().value;
    assert_ne!(other.robots[0].pose.heading, found.robots[0].pose.heading);
}

#[test]
fn a_script_without_a_world_gets_a_box() {
    let start = Some(Pose::from_mm_deg(1.0, 2.0, 3.0));
    assert_eq!(scene("S4 1 2 3").world, World { start, ..World::walled(2.0, 2.0) });
}

#[test]
fn reserved_names_stay_built_in() {
    let text = "robot fake.robi\nS4 1 2 3";
    assert_eq!(*scene(text).robots[0].spec, RobotSpec::s4());
    assert_eq!(warnings(text), ["test.sim:1:7: the name `s4` is reserved; the built-in robot is used"]);
    assert_eq!(scene("robot fake.robi\nfake 1 2 3").robots[0].spec.name, "s4");
}

#[test]
fn absent_files_of_built_in_robots_are_made_up_for() {
    let text = "robot robots\\labbot.robi\nLabBot 1 2 3";
    assert_eq!(*scene(text).robots[0].spec, RobotSpec::labbot());
    assert_eq!(
        warnings(text),
        [r"test.sim:1:7: `robots\\labbot.robi` does not exist; the built-in robot is used"]
    );
    assert!(failure("robot rover.robi").contains("does not exist"));
}

#[test]
fn old_and_unknown_lines_are_skipped_with_their_place() {
    let text = "maze old.maz\nrobi S5.robi drive.dll 400 400 0\nobject 1 2 3 0.5 ball.ob\nworld w.wld\n\
                Rover 1 2 3\nfrobnicate\nsettings VIS FAST\ncan 1 2 3 extra\nS4 1 2 3 a.x b.x";
    assert_eq!(
        warnings(text),
        [
            "test.sim:1:1: a line of EyeSim 6, skipped; expected `world FILE`",
            "test.sim:2:1: a line of EyeSim 6, skipped; expected `robot FILE` and `NAME X Y PHI PROGRAM`",
            "test.sim:3:1: a line of EyeSim 6, skipped; expected `object FILE` and `NAME X Y PHI`",
            "test.sim:7:14: unknown setting `FAST`; ignored",
            "test.sim:9:14: `b.x` is more than belongs in this line; ignored",
            "test.sim:5:1: `Rover` is neither a keyword nor a known robot or object; the line is skipped",
            "test.sim:6:1: `frobnicate` is neither a keyword nor a known robot or object; the line is skipped",
            "test.sim:8:1: `extra` is more than belongs in the line of an object; ignored",
        ]
    );
}

#[test]
fn errors_stand_where_the_reference_stands() {
    assert_eq!(
        failure("\n world  nowhere.wld"),
        "test.sim:2:9: found `nowhere.wld`, which does not exist; expected a file that exists"
    );
    assert_eq!(
        failure("world test.sim"),
        "test.sim:1:7: found `test.sim`; expected a file that ends in .wld, .maz, .yaml, .yml or .map"
    );
    assert_eq!(
        failure("robot broken.robi"),
        "broken.robi:2:10: found `x`; expected the wheel's highest speed per second in degrees, a number"
    );
    assert_eq!(failure("S4 1 2"), "test.sim:1:7: found the end of the line; expected the heading in degrees");
    assert_eq!(
        failure("obj cone.esObj\ncone-o 1 x 2"),
        "test.sim:2:10: found `x`; expected y in millimetres, a number"
    );
    assert_eq!(
        failure("world m.MAZ\nS4 z"),
        "test.sim:2:1: found the letter `z`; expected a letter that stands in the maze"
    );
}

#[test]
fn a_tolerant_reader_goes_on_behind_errors() {
    let text = "world nowhere.maz\nrobot broken.robi\nS4 1 2\ncan 5\nmarker 1\n\"\nobject missing.esObj\nbroken 1 2 3\n\
                can 500 600 0\nS4 z a.py\nLabBot z 90 b.py\nS4 400 2500 0 c.py";
    let parsed = parse_tolerantly(text, "test.sim", &mut files()).unwrap();
    let warnings: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings.len(), 10, "{warnings:#?}");
    assert_eq!(
        warnings[0],
        "test.sim:3:7: found the end of the line; expected the heading in degrees; the line is skipped"
    );
    let scene = parsed.value;
    assert_eq!((scene.world.floor.max, scene.world.walls.len()), (Point::new(2.0, 4.0), 4));
    let robots: Vec<_> = scene.robots.iter().map(|r| (r.program.as_deref(), r.pose.x, r.pose.y)).collect();
    assert_eq!(
        robots,
        [(None, 0.001, 0.002), (Some("a.py"), 0.5, 0.5), (Some("b.py"), 1.0, 0.5), (Some("c.py"), 0.4, 2.5)]
    );
    assert_eq!((scene.robot_numbers(), scene.object_numbers()), (vec![1, 3, 4, 5], vec![2]));
}

#[test]
fn what_eyesim_brings_along_is_known_without_its_files() {
    let text = "settings VIS\nworld ../../worlds/small/Soccer1998.wld\nrobot \"../../robots/Ackermann/SAE.robi\"\n\
                object \"../../objects/ConeOrange/coneorange.esObj\"\nSAE 500 500 90\nCone-O 600 600 0\n\
                Cone-O 900 600 0\nStopSign 1000 600 0\nSoccerBot 200 200 0\ncubot-R 300 200 0";
    let scene = scene(text);
    assert_eq!(scene.world.walls.len(), World::predefined("soccer1998").unwrap().walls.len());
    let robots: Vec<_> = scene.robots.iter().map(|robot| robot.spec.name.as_str()).collect();
    assert_eq!(robots, ["SAE", "SoccerBot", "Cubot-r"]);
    let objects: Vec<_> = scene.world.objects.iter().map(|object| object.kind.name.as_str()).collect();
    assert_eq!(objects, ["Cone-O", "Cone-O", "StopSign"]);
    assert!(
        Arc::ptr_eq(&scene.world.objects[0].kind, &scene.world.objects[1].kind),
        "one kind for all cones"
    );
    assert_eq!(
        warnings(text),
        [
            "test.sim:2:7: `../../worlds/small/Soccer1998.wld` does not exist; the built-in world is used",
            "test.sim:3:7: `../../robots/Ackermann/SAE.robi` does not exist; the built-in robot is used",
            "test.sim:4:8: `../../objects/ConeOrange/coneorange.esOb…` does not exist; the built-in object is used",
        ]
    );
}

#[test]
fn a_stand_in_has_the_name_that_the_script_gives_it() {
    let text = "robot a/Ackermann/x5.robi\nobject oaktree.esObj\nobject \"b/lamp.esObj\"\n\
                Oak-Tree 100 200 0\nOak-Tree 300 200 0\nLamp 500 500 0\nRacer 1 2 3 go.py\nNobody 1 2 3";
    let parsed = parse_tolerantly(text, "test.sim", &mut files()).unwrap();
    let objects: Vec<_> = parsed.value.world.objects.iter().map(|object| object.kind.name.as_str()).collect();
    assert_eq!(objects, ["Oak-Tree", "Oak-Tree", "Lamp"]);
    let said = |text: &str| parsed.warnings.iter().any(|warning| warning.to_string().contains(text));
    assert!(said(": an object takes the place of `Lamp`") && said(": a robot takes the place of `Racer`"));
    assert_eq!((parsed.value.robots.len(), parsed.value.robots[0].spec.name.as_str()), (1, "Racer"));
    assert!(matches!(parsed.value.robots[0].spec.drive, crate::world::DriveSpec::Ackermann { .. }));
    let last = parsed.warnings.last().unwrap().to_string();
    assert!(last.contains("`Nobody` is neither"), "{last}");
    assert!(failure(text).contains("x5.robi"));
}

#[test]
fn images_and_models_are_looked_up_from_the_files_that_name_them() {
    let mut memory = files();
    let mut add = |name: &str, text: &str| memory.0.insert(name.into(), text.as_bytes().to_vec());
    add("carpet.wld", "floor 1000 1000\nfloor_texture carpet.jpg\nterrain 1000 1000 50 hills.png\n");
    add("flag.esObj", "obj flag.obj\nbox 0 50 0 100 100 20\n");
    let text = "world carpet.wld\nobject flag.esObj\nflag 100 100 0\n";
    let missing = |memory: &mut MemoryFiles| parse(text, "test.sim", memory).unwrap_err().to_string();
    assert!(missing(&mut memory).starts_with("carpet.wld:2:15: found `carpet.jpg`, which does not exist"));
    memory.0.insert("carpet.jpg".into(), b"P6 1 1 255 abc".to_vec());
    assert!(missing(&mut memory).starts_with("carpet.wld:3:22: found `hills.png`"));
    memory.0.insert("hills.png".into(), b"broken".to_vec());
    assert!(missing(&mut memory).starts_with("carpet.wld:3:22: found `hills.png`, a broken image"));
    memory.0.insert("hills.png".into(), b"P5 1 1 255 a".to_vec());
    assert!(missing(&mut memory).starts_with("flag.esObj:1:5: found `flag.obj`"));
    memory.0.insert("flag.obj".into(), b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec());
    let scene = parse(text, "test.sim", &mut memory).unwrap().value;
    assert!(scene.world.floor_texture.unwrap().image.is_some());
    assert!(scene.world.terrain.unwrap().surface.is_some());
    assert_eq!(scene.world.objects[0].kind.mesh.as_ref().unwrap().faces.len(), 1);
}

#[test]
fn a_tolerant_reader_has_a_gray_floor_for_a_missing_one() {
    let mut memory = files();
    memory.0.insert("carpet.wld".into(), b"floor 1000 1000\nfloor_texture carpet.jpg\n".to_vec());
    let parsed = parse_tolerantly("world carpet.wld\n", "test.sim", &mut memory).unwrap();
    assert_eq!(
        (parsed.value.world.floor.max, parsed.value.world.floor_texture),
        (Point::new(1.0, 1.0), None)
    );
    let warning = parsed.warnings[0].to_string();
    assert!(warning.starts_with("carpet.wld:2:15:") && warning.ends_with("the floor is gray"), "{warning}");
}

#[test]
fn what_is_tolerated_changes_nothing_that_is_right() {
    let text = "world w.wld\ncan 1 2 3\nS4 100 200 90 a.py\ngolf 1 2 3\nLabBot 1 2 30 -45";
    assert_eq!(parse_tolerantly(text, "test.sim", &mut files()).unwrap().value, scene(text));
    let script = SimFile::for_scene(&scene(text), "w.wld");
    assert_eq!(script, parse_document(text, "t").unwrap().value, "robots and objects keep their order");
}

#[test]
fn file_names_may_have_blanks_and_backslashes() {
    let mut memory = files();
    memory.0.insert("my worlds/a b.maz".into(), MAZE.as_bytes().to_vec());
    for text in ["world 'my worlds/a b.maz'", "world my worlds/a b.maz # here"] {
        let parsed = parse(text, "t.sim", &mut memory).unwrap();
        assert_eq!(parsed.value.world.places.len(), 5, "{text}");
    }
}

#[test]
fn a_scene_gives_its_script_back() {
    let text =
        "world w.wld\nsettings TRACE\nS4 100 200 90 a.py\nLabBot 1 2 30 -45\ncan 5 6 7\nmarker 1 2 3 4 5\n";
    let script = SimFile::for_scene(&scene(text), "w.wld");
    assert_eq!(script, parse_document(text, "t").unwrap().value);
    assert_eq!(scene(&print(&script)), scene(text));
}

fn path() -> impl Strategy<Value = String> {
    r"[a-zA-Z$%/\\ .;#']{0,6}[a-z]\.(wld|maz|robi|x)"
}

fn pose() -> impl Strategy<Value = Pose> {
    (-99.0..99.0f64, -99.0..99.0f64, -180..=180i32)
        .prop_map(|(x, y, deg)| Pose::new(x, y, units::from_deg(f64::from(deg))))
}

fn position() -> impl Strategy<Value = Position> {
    let heading = proptest::option::of((-180..=180i32).prop_map(|deg| units::from_deg(f64::from(deg))));
    prop_oneof![
        (pose(), proptest::option::of(-9.0..9.0f64))
            .prop_map(|(pose, elevation)| Position::Pose { pose, elevation }),
        (proptest::char::range('a', 'z'), heading)
            .prop_map(|(letter, heading)| Position::Letter { letter, heading }),
    ]
}

fn marker() -> impl Strategy<Value = Marker> {
    (pose(), any::<[u8; 4]>()).prop_map(|(pose, [r, g, b, alpha])| Marker {
        position: pose.position(),
        colour: Colour::new(r, g, b),
        alpha,
    })
}

fn statement() -> impl Strategy<Value = Statement> {
    let program = proptest::option::of(prop_oneof![path(), "[0-9]{1,3}"]);
    let settings = (any::<bool>(), any::<bool>());
    prop_oneof![
        path().prop_map(Statement::World),
        path().prop_map(Statement::Robot),
        path().prop_map(Statement::Object),
        settings.prop_map(|(show_sensors, show_traces)| Statement::Settings(Settings {
            show_sensors,
            show_traces
        })),
        ("[A-Z0-9][A-Za-z -]{1,8}[0-9]", position(), program)
            .prop_map(|(name, at, program)| Statement::Place { name, at, program }),
        marker().prop_map(Statement::Marker),
    ]
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_printed_reads_back(statements in proptest::collection::vec(statement(), 0..6)) {
        let script = SimFile { statements, ..SimFile::default() };
        let parsed = parse_document(&print(&script), "t.sim").unwrap();
        prop_assert_eq!(parsed.warnings, vec![]);
        prop_assert_eq!(parsed.value, script);
    }

    #[test]
    fn what_was_read_survives_printing(
        text in "((world|S4|can|x|S|marker|settings|object| |\"|'|;|#|-|[0-9.]{1,3}| [0-9]{1,2}| a\\.x|\"90\"|\t){1,9}\n){0,6}"
    ) {
        if let Ok(parsed) = parse_document(&text, "t.sim") {
            prop_assert_eq!(parse_document(&print(&parsed.value), "t.sim").unwrap().value, parsed.value);
        }
    }
}
