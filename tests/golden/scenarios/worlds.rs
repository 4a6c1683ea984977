//! Worlds: generators, file formats, rays and contacts, clearance and ways through; and the streams of random
//! numbers.

use std::collections::BTreeMap;

use roverlab::geometry::{Aabb, Point, Pose, direction, math};
use roverlab::io::Result;
use roverlab::nav::Reachability;
use roverlab::random::Stream;
use roverlab::world::formats::{
    MemoryFiles, SourceFile, bitmap, esobj, maz, movingai, parse_robot, parse_scene, parse_scene_tolerantly,
    robi, ros_map, sim, wld,
};
use roverlab::world::generate::{CourseFamily, RoomOptions, room as generate_room};
use roverlab::world::space::{Scanner, Solid, Space, Span};
use roverlab::world::{Clearance, Footprint, RobotSpec, Scene, World};

use super::{Scenario, note, other, room};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("random-streams", streams),
    Scenario::new("world-generators", generators),
    Scenario::new("world-formats", formats),
    Scenario::new("robot-formats", robots),
    Scenario::new("map-formats", maps),
    Scenario::new("world-space", space),
    Scenario::new("reachability", reachability),
];

/// Draws of every kind, and the elementary functions, which have the same bits on every platform.
fn streams() -> Result<String> {
    let mut log = String::new();
    for mut stream in [Stream::new(0), Stream::new(151).child("world", 0), Stream::new(151).child("world", 1)]
    {
        for _ in 0..20 {
            let (bits, uniform, normal) = (stream.bits(), stream.uniform(), stream.normal());
            note(&mut log, "draw", &(bits, uniform, normal, stream.between(-3.0, 2.0), stream.below(1000)));
            let mut items = [0, 1, 2, 3, 4, 5, 6];
            stream.shuffle(&mut items);
            note(&mut log, "order", &(items, stream.chance(0.3)));
            let x = 4.0 * uniform;
            note(&mut log, "circle", &(math::sin_cos(normal), math::tan(x), math::atan2(normal, uniform)));
            note(&mut log, "arcs", &(math::asin(uniform), math::acos(uniform), math::atan(x)));
            note(&mut log, "powers", &(math::exp(normal), math::ln(uniform), math::pow(x, normal)));
            note(&mut log, "length", &math::hypot(x, normal));
        }
    }
    Ok(log)
}

fn note_world(log: &mut String, world: &World) {
    note(log, "floor", &(world.floor, world.start, world.water_level));
    for wall in &world.walls {
        note(log, "wall", &(wall.line, wall.thickness, wall.height, wall.colour));
    }
    for object in &world.objects {
        let kind = &object.kind;
        note(log, "object", &(&kind.name, kind.shape, kind.colour, kind.mass, kind.fixed, object.pose));
    }
    for marker in &world.markers {
        note(log, "marker", &(marker.position, marker.colour, marker.alpha));
    }
    for place in &world.places {
        note(log, "place", &(place.letter, place.position, place.heading));
    }
}

fn generators() -> Result<String> {
    const FAMILIES: [CourseFamily; 4] = [
        CourseFamily::LocalMinima,
        CourseFamily::ComplexTerrain,
        CourseFamily::SemiConvex,
        CourseFamily::Unreachable,
    ];
    let mut log = String::new();
    for (family, seed) in FAMILIES.into_iter().zip(152..) {
        let course = family.course(&mut Stream::new(seed)).map_err(other)?;
        note(&mut log, "course", &(course.start, course.goal, course.reachable, &course.obstacles));
        note_world(&mut log, &course.world);
    }
    for seed in 156..166 {
        let room = generate_room(&mut Stream::new(seed), &RoomOptions::default()).map_err(other)?;
        note(&mut log, "room", &(room.start, &room.corners, &room.features));
        note_world(&mut log, &room.world);
    }
    Ok(log)
}

fn note_robot(log: &mut String, spec: &RobotSpec) {
    note(log, "robot", &(&spec.name, &spec.drive, spec.motor, spec.footprint, spec.height, spec.mass));
    note(log, "sensors", &(&spec.psds, &spec.lidar, &spec.camera));
    note(log, "body", &spec.body);
}

/// The files that the scenes below name.
fn files() -> MemoryFiles {
    let files: [(&str, &[u8]); 13] = [
        (".\\room.wld", include_bytes!("../../data/formats/room.wld")),
        ("room.wld", include_bytes!("../../data/formats/room.wld")),
        ("cart.robi", include_bytes!("../../data/formats/cart.robi")),
        ("sign.esObj", include_bytes!("../../data/formats/sign.esObj")),
        ("small.maz", include_bytes!("../../data/formats/small.maz")),
        ("room.pgm", include_bytes!("../../data/formats/room.pgm")),
        ("ball.esObj", include_bytes!("../../data/formats/ball.esObj")),
        ("tiles 1.png", include_bytes!("../../data/formats/tiles 1.png")),
        ("sign.obj", include_bytes!("../../data/formats/sign.obj")),
        ("sign.mtl", include_bytes!("../../data/formats/sign.mtl")),
        ("plate.png", include_bytes!("../../data/formats/plate.png")),
        ("ball.obj", include_bytes!("../../data/formats/ball.obj")),
        ("cart.obj", include_bytes!("../../data/formats/cart.obj")),
    ];
    MemoryFiles(
        files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).collect::<BTreeMap<_, _>>(),
    )
}

fn note_scene(log: &mut String, scene: &Scene) {
    note_world(log, &scene.world);
    for robot in &scene.robots {
        note(log, "placed", &(robot.pose, robot.elevation, &robot.program, robot.objects_before));
        note_robot(log, &robot.spec);
    }
    note(log, "numbers", &(scene.robot_numbers(), scene.object_numbers(), &scene.settings));
}

/// Worlds, mazes and scenes read, printed, and read again; and what is said about broken ones.
fn formats() -> Result<String> {
    let mut log = String::new();
    for text in [include_str!("../../data/formats/room.wld"), include_str!("../../data/field.wld")] {
        let world = wld::parse(text, "a.wld").map_err(other)?;
        note(&mut log, "warnings", &world.warnings);
        note_world(&mut log, &world.value);
        log += &wld::print(&world.value);
    }
    for text in [include_str!("../../data/formats/first.MAZ"), include_str!("../../data/maze.maz")] {
        let maze = maz::parse_maze(text, "a.maz").map_err(other)?.value;
        note_world(&mut log, &maze.to_world());
        log += &maz::print(&maze);
    }
    for (name, text) in [
        ("room.sim", include_str!("../../data/formats/room.sim")),
        ("maze.sim", include_str!("../../data/formats/maze.sim")),
    ] {
        let scene = parse_scene(text.into(), name, &mut files()).map_err(other)?;
        note(&mut log, "warnings", &scene.warnings);
        note_scene(&mut log, &scene.value);
        let document = sim::parse_document(text, name).map_err(other)?.value;
        log += &sim::print(&document);
        log += &sim::print(&sim::SimFile::for_scene(&scene.value, "again.wld"));
        let broken = text.replace("world ", "wrold ").replace("500", "x500");
        note(&mut log, "broken", &parse_scene(broken.clone().into(), name, &mut files()).map(|_| ()));
        let tolerant = parse_scene_tolerantly(broken.into(), name, &mut files());
        note(&mut log, "tolerated", &tolerant.map(|scene| scene.warnings));
    }
    Ok(log)
}

/// Robots and objects: the predefined ones, and those of files.
fn robots() -> Result<String> {
    let mut log = String::new();
    for spec in [RobotSpec::s4(), RobotSpec::labbot(), RobotSpec::omni(), RobotSpec::car()] {
        note_robot(&mut log, &spec);
        let text = robi::print(&spec);
        note_robot(&mut log, &robi::parse(&text, "printed.robi").map_err(other)?.value);
        log += &text;
    }
    for bytes in
        [&include_bytes!("../../data/formats/car.robi")[..], include_bytes!("../../data/formats/cart.robi")]
    {
        let spec = parse_robot(bytes.to_vec(), "a.robi").map_err(other)?;
        note(&mut log, "warnings", &spec.warnings);
        note_robot(&mut log, &spec.value);
    }
    for text in [include_str!("../../data/formats/ball.esObj"), include_str!("../../data/formats/sign.esObj")]
    {
        let kind = esobj::parse(text, "a.esObj").map_err(other)?;
        note(&mut log, "kind", &(kind.warnings, &kind.value.name, kind.value.shape, &kind.value.body));
        log += &esobj::print(&kind.value);
    }
    Ok(log)
}

/// Grids of ROS, of MovingAI and of bitmaps.
fn maps() -> Result<String> {
    let mut log = String::new();
    for (name, text) in [
        ("room.yaml", include_str!("../../data/formats/room.yaml")),
        ("scale.yml", include_str!("../../data/formats/scale.yml")),
    ] {
        let map = ros_map::parse(text, name, &mut files()).map_err(other)?;
        let grid = &map.value.grid;
        note(&mut log, name, &(map.warnings, grid.resolution(), grid.origin(), grid.count_walls()));
        for row in 0..grid.height() {
            let cells = (0..grid.width()).map(|column| grid.occupancy(column, row));
            note(&mut log, "row", &cells.collect::<Vec<_>>());
        }
        note_world(&mut log, &grid.to_world());
        log += &ros_map::print(&map.value);
        note(&mut log, "image", &ros_map::print_image(&map.value));
    }
    for (map, scenarios) in [
        (include_str!("../../data/grids/yard.map"), include_str!("../../data/grids/yard.map.scen")),
        (include_str!("../../data/grids/spiral.map"), include_str!("../../data/grids/spiral.map.scen")),
    ] {
        let map = movingai::parse_map(map, "a.map").map_err(other)?.value;
        note(&mut log, "free", &map.grid().free_cells().collect::<Vec<_>>());
        log += &movingai::print_map(&map);
        let queries = movingai::parse_scenarios(scenarios, "a.scen").map_err(other)?.value;
        note(&mut log, "queries", &queries);
        log += &movingai::print_scenarios(&queries);
    }
    let source =
        SourceFile { name: "room.pgm".into(), bytes: include_bytes!("../../data/formats/room.pgm").to_vec() };
    let bitmap = bitmap::parse(&source).map_err(other)?.value;
    note(&mut log, "bitmap", &bitmap.free_cells().collect::<Vec<_>>());
    Ok(log)
}

/// Rays, scans, contacts and clearances among walls and things that move.
fn space() -> Result<String> {
    let mut log = String::new();
    let mut space = Space::new(&room().walls);
    let span = Span { bottom: 0.0, top: 0.2 };
    let outlines = [
        Footprint::Disc { radius: 0.1 },
        Footprint::Rectangle(Aabb::new(Point::new(-0.1, -0.05), Point::new(0.15, 0.08))),
    ];
    let solids = outlines.map(|outline| space.add(Solid::new(outline, Pose::new(2.2, 1.4, 0.3), 0.0, 0.15)));
    let mut scanner = Scanner::new(-3.0, 0.06, 101, 0.05, -0.02, 4.0);
    let mut ranges = vec![0.0; scanner.beams()];
    let mut contacts = Vec::new();
    for step in 0..12 {
        let along = 0.25 * f64::from(step);
        space.set_pose(solids[step as usize % 2], Pose::new(0.1 + along, 0.8, 0.4 * along));
        let pose = Pose::new(1.1, 0.9, along);
        space.scan(&mut scanner, &pose, Some(solids[0]), &mut ranges);
        note(&mut log, "scan", &ranges);
        note(&mut log, "ray", &space.cast_ray(pose.position(), direction(along), 0.05, 5.0, None));
        for outline in &outlines {
            let pose = Pose::new(0.05 + along, 0.77, along);
            space.contacts(outline, &pose, span, None, &mut contacts);
            let touches = contacts.drain(..).map(|contact| (contact.normal, contact.depth));
            note(&mut log, "contacts", &touches.collect::<Vec<_>>());
            let walls = space.walls_clearance(outline, &pose, span, 0.5);
            note(
                &mut log,
                "clearance",
                &(walls, space.clearance(outline, &pose, span, 0.5, Some(solids[1]))),
            );
        }
    }
    Ok(log)
}

fn reachability() -> Result<String> {
    let mut log = String::new();
    let world = room();
    let clearance = Clearance::new(&world, 0.02, 0.3).map_err(other)?;
    note(
        &mut log,
        "distances",
        &(0..clearance.raster().cells()).map(|cell| clearance.at(cell)).collect::<Vec<_>>(),
    );
    for way in [
        Reachability::new(&world, 0.06, Reachability::DEFAULT_RESOLUTION).map_err(other)?,
        Reachability::from_clearance(&clearance, 0.25),
    ] {
        let start = Point::new(0.3, 0.3);
        for goal in [(2.7, 1.7), (1.2, 1.0), (2.2, 1.5)].map(|(x, y)| Point::new(x, y)) {
            note(&mut log, "region", &(way.is_free(goal), way.connected(start, goal), way.region_size(goal)));
            let path = way.shortest_path(start, goal).map(|path| (path.length, path.expanded, path.points));
            note(&mut log, "path", &path);
        }
    }
    Ok(log)
}
