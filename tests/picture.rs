//! Pictures as files: what is shown where, and what happens when a file cannot be written.

#[allow(unreachable_pub, reason = "the library's own, which is public there with the feature `testing`")]
#[path = "../src/testing/cases.rs"]
mod cases;

use std::fs;
use std::path::PathBuf;

use proptest::prelude::*;
use roverlab::geometry::{Point, Pose};
use roverlab::picture::{FileType, Mark, Picture, SaveError, Style};
use roverlab::world::{Colour, Footprint, RobotSpec, World};

/// A fresh folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("picture").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The centres of all circles of a colour, in pixels.
fn circles(svg: &str, colour: Colour) -> Vec<(f64, f64)> {
    let value = |line: &str, name: &str| -> f64 {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    svg.lines()
        .filter(|line| line.starts_with("<circle") && line.contains(&format!("fill=\"{colour}\"")))
        .map(|line| (value(line, "cx"), value(line, "cy")))
        .collect()
}

proptest! {
    #![proptest_config(cases::cases(256))]
    #[test]
    fn the_picture_keeps_directions_and_proportions(
        x in 0.0..10.0f64, y in 0.0..6.0f64, dx in -3.0..3.0f64, dy in -3.0..3.0f64,
    ) {
        let colour = Colour::new(1, 2, 3);
        let mut picture = Picture::new(&World::walled(10.0, 6.0));
        picture.disc(Point::new(x, y), 0.1, Style::new(colour)).disc(Point::new(x + dx, y + dy), 0.1, Style::new(colour));
        let found = circles(&picture.to_svg(), colour);
        prop_assert_eq!(found.len(), 2);
        let (right, up) = (found[1].0 - found[0].0, found[0].1 - found[1].1);
        // Coordinates have two decimals, so the two products agree to a few hundredths of a pixel.
        prop_assert!((right * dy - up * dx).abs() < 0.1, "{dx}, {dy} became {right}, {up}");
        prop_assert!(right * dx + up * dy > -0.1);
    }
}

#[test]
fn beams_without_a_return_draw_nothing() {
    let mut picture = Picture::new(&World::walled(1.0, 1.0));
    let without = picture.to_svg();
    picture.points([Point::new(f64::INFINITY, 0.5)], Style::new(Colour::RED));
    picture.points([], Style::new(Colour::RED));
    assert!(!without.contains("h0") && !picture.to_svg().contains("h0"));
}

#[test]
fn a_jump_of_the_odometry_does_not_shrink_the_world() {
    let mut near = Picture::new(&World::walled(2.0, 1.0));
    near.odometry_path([Point::new(0.5, 0.5), Point::new(1.0, 0.5)]);
    let mut far = Picture::new(&World::walled(2.0, 1.0));
    far.odometry_path([Point::new(0.5, 0.5), Point::new(1.0, 0.5), Point::new(1e6, 0.5)]);
    let size = |picture: &Picture| picture.to_svg().lines().next().unwrap().to_owned();
    assert_eq!(size(&near), size(&far));
}

/// A robot that drives, turns and comes back, with what is seen of it at times.
fn moving() -> Picture {
    let mut picture = Picture::new(&World::walled(4.0, 3.0));
    let trail: Vec<(f64, Pose)> = (0..=300)
        .map(|i| f64::from(i) / 10.0)
        .map(|time| (time, Pose::new(0.5 + 0.1 * time, 1.0 + 0.02 * time, 0.3 * time)))
        .collect();
    picture.drive(&trail, &RobotSpec::s4().footprint);
    picture.trace(trail.iter().map(|(time, pose)| (*time, pose.position())), Style::odometry());
    picture.speed_trace(trail.iter().map(|(time, pose)| (*time, pose.position(), pose.heading)));
    picture.mark(Mark::Start, trail[0].1.position()).mark(Mark::Goal, trail[300].1.position());
    picture.during(12.0..).mark_named(Mark::HitPoint, Point::new(1.7, 1.24), "H1");
    picture.during(3.0..5.0).disc(Point::new(2.0, 2.0), 0.2, Style::new(Colour::new(1, 2, 3)));
    picture
}

#[test]
fn a_picture_shows_what_is_there_at_a_time() {
    let picture = moving();
    assert_eq!(picture.duration(), 30.0);
    let shows = |time: f64, text: &str| picture.at(time).to_svg().contains(text);
    assert!(!shows(11.9, "hit point") && shows(12.0, "hit point"));
    assert!(!shows(2.9, "#010203") && shows(4.0, "#010203") && !shows(5.1, "#010203"));
    // The still picture is that of the end.
    assert_eq!(picture.to_svg(), picture.at(30.0).to_svg());
    assert_ne!(picture.to_svg(), picture.at(20.0).to_svg());
}

#[test]
fn a_moving_picture_moves_what_has_times_and_nothing_else() {
    let svg = moving().to_moving_svg();
    let times = |text: &str| svg.matches(text).count();
    // The robot's place and heading; three lines that grow; a mark, its name, and a disc that come and go;
    // the bar.
    assert_eq!((times("<animateTransform"), times("<mask"), times("<animate ")), (2, 2, 7));
    assert_eq!(times("attributeName=\"visibility\""), 3);
    assert!(svg.contains("2.1 times as fast") && svg.len() < 12_000, "{} bytes", svg.len());
    let still = Picture::new(&World::walled(1.0, 1.0));
    assert_eq!(still.to_moving_svg(), still.to_svg());
}

#[test]
fn the_goal_rings_the_robot_that_stands_there() {
    let footprint = RobotSpec::s4().footprint;
    let rings = |place: Point| {
        let mut picture = Picture::new(&World::walled(2.0, 2.0));
        picture.mark(Mark::Goal, Point::new(1.0, 1.0)).robot(Pose::new(place.x, place.y, 0.0), &footprint);
        let svg = picture.to_svg();
        let radii = svg
            .match_indices(" r=\"")
            .map(|(at, text)| svg[at + text.len()..].split('"').next().unwrap().parse::<f64>().unwrap());
        radii.fold(0.0, f64::max)
    };
    assert!(rings(Point::new(1.01, 1.0)) > rings(Point::new(0.3, 1.0)) + 4.0);
}

#[test]
fn png_files_do_not_move() {
    let error = moving().save_moving("run.png").unwrap_err().to_string();
    assert!(error.contains("run.png") && error.ends_with("expected a name that ends in .svg"), "{error}");
}

#[test]
fn panels_stand_apart_with_their_titles() {
    let mut panel = Picture::new(&World::walled(1.0, 1.0));
    panel.title("one").disc(Point::new(0.5, 0.5), 0.1, Style::new(Colour::new(1, 2, 3)));
    let svg = Picture::panels(&[panel.clone(), panel.clone(), panel], 2).to_svg();
    let found = circles(&svg, Colour::new(1, 2, 3));
    assert_eq!((found.len(), svg.lines().filter(|line| *line == "one").count()), (3, 3));
    assert!(found[1].0 > found[0].0 + 50.0 && found[1].1 == found[0].1);
    assert!(found[2].0 == found[0].0 && found[2].1 > found[0].1 + 50.0);
}

#[test]
fn long_paths_stay_small() {
    let mut picture = Picture::new(&World::walled(4.0, 4.0));
    picture.true_path((0..200_000).map(|i| Point::new(0.5 + 3.0 * f64::from(i) / 200_000.0, 2.0)));
    assert!(picture.to_svg().len() < 60_000);
}

#[test]
fn texts_cannot_break_the_document() {
    let mut picture = Picture::new(&World::walled(1.0, 1.0));
    picture.title("</text><script>alert(1)</script> & \u{1}\"'").mark_named(
        Mark::HitPoint,
        Point::new(0.5, 0.5),
        "<b>",
    );
    let svg = picture.to_svg();
    assert!(!svg.contains("<script") && !svg.contains('\u{1}') && svg.contains("&lt;b&gt;"));
}

#[test]
fn the_legend_counts_and_says_each_thing_once() {
    let mut picture = Picture::new(&World::walled(2.0, 2.0));
    picture.true_path([Point::new(0.1, 0.1), Point::new(1.0, 1.0)]);
    picture.true_path([Point::new(0.1, 0.3), Point::new(1.0, 1.3)]);
    picture.mark(Mark::HitPoint, Point::new(0.5, 0.5)).mark(Mark::HitPoint, Point::new(0.6, 0.5));
    let svg = picture.to_svg();
    let times = |text: &str| svg.lines().filter(|line| line.contains(text)).count();
    assert_eq!((times("true path"), times("hit point ×2"), times("leave point")), (1, 1, 0));
}

#[cfg(feature = "png")]
#[test]
fn a_png_shows_what_the_svg_describes() {
    let path = folder("png").join("run.PNG");
    let mut picture = Picture::new(&World::walled(2.0, 1.0));
    picture.title("Title").disc(Point::new(1.0, 0.5), 0.2, Style::new(Colour::new(10, 200, 30)).filled(1.0));
    picture.save(&path).unwrap();
    let image =
        image::ImageReader::open(&path).unwrap().with_guessed_format().unwrap().decode().unwrap().to_rgb8();
    let svg = picture.to_svg();
    let (x, y) = circles(&svg, Colour::new(10, 200, 30))[0];
    assert_eq!(image.get_pixel((2.0 * x) as u32, (2.0 * y) as u32).0, [10, 200, 30]);
    assert_eq!(image.get_pixel(20, 4).0, [255, 255, 255]);
    let title = (0..80)
        .flat_map(|y| (0..200).map(move |x| (x, y)))
        .filter(|(x, y)| image.get_pixel(*x, *y).0[0] < 100);
    assert!(title.count() > 100, "the title is drawn with the font that is built in");
}

#[test]
fn an_svg_file_holds_the_document() {
    let path = folder("svg").join("a/new/folder/run.svg");
    let mut picture = Picture::new(&World::empty(1.0, 1.0));
    picture.robot(Pose::new(0.5, 0.5, 0.0), &RobotSpec::s4().footprint);
    picture.save(&path).unwrap();
    picture.robot(Pose::new(0.2, 0.5, 0.0), &Footprint::Disc { radius: 0.1 });
    picture.save(&path).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), picture.to_svg());
}

#[test]
fn names_of_other_files_are_refused() {
    for name in ["run.gif", "run", "run.svg.txt", ".svg", ""] {
        let error = Picture::new(&World::empty(1.0, 1.0)).save(name).unwrap_err();
        assert!(matches!(error, SaveError::Extension { .. }), "{name}: {error:?}");
        assert!(error.to_string().ends_with("expected a name that ends in .svg or .png"), "{error}");
    }
    match FileType::of("a/b.png") {
        Ok(kind) => assert!(cfg!(feature = "png") && kind == FileType::Png),
        Err(error) => assert!(!cfg!(feature = "png") && matches!(error, SaveError::NoPng { .. }), "{error}"),
    }
}

#[test]
fn a_failed_write_is_reported_and_leaves_nothing_behind() {
    let folder = folder("failed");
    let picture = Picture::new(&World::empty(1.0, 1.0));
    fs::write(folder.join("file"), "").unwrap();
    let error = picture.save(folder.join("file/run.svg")).unwrap_err();
    assert!(matches!(error, SaveError::Write { .. }) && error.to_string().contains("run.svg"), "{error}");

    let taken = folder.join("taken.svg");
    fs::create_dir(&taken).unwrap();
    assert!(matches!(picture.save(&taken).unwrap_err(), SaveError::Write { .. }));
    let mut left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["file", "taken.svg"]);
}

#[test]
fn a_circle_without_filling_lies_above_the_object_in_it() {
    let mut world = World::walled(2.0, 2.0);
    world.objects.push(roverlab::world::Object::new(
        std::sync::Arc::new(roverlab::world::ObjectKind::new(
            "can",
            roverlab::world::Shape::Cylinder { radius: 0.05, height: 0.1 },
            Colour::new(9, 8, 7),
        )),
        Pose::new(1.0, 1.0, 0.0),
    ));
    let above = |fill: f64| {
        let mut picture = Picture::new(&world);
        picture.disc(Point::new(1.0, 1.0), 0.1, Style::new(Colour::new(1, 2, 3)).filled(fill));
        let svg = picture.to_svg();
        let lowest = svg.split("<circle").nth(1).unwrap();
        !lowest.contains(&Colour::new(1, 2, 3).to_string())
    };
    assert!(above(0.0) && !above(0.5));
}
