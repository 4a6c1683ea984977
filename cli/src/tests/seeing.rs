//! The commands `camera`, `edges`, `color-tracking` and `motion` as wholes.

use std::path::PathBuf;

use super::support::{assert_outcome, run, temporary, text};
use crate::edges;
use clap::ValueEnum;
use image::RgbImage;

/// An image of noisy coloured squares.
fn squares(name: &str) -> PathBuf {
    let file = temporary(name);
    let image = RgbImage::from_fn(96, 64, |x, y| {
        let noise = (x * 31 + y * 17) % 7;
        match (x / 16 + y / 16) % 3 {
            0 => image::Rgb([200 + noise as u8, 20, 30]),
            1 => image::Rgb([40, 60 + noise as u8, 190]),
            _ => image::Rgb([120, 124 + noise as u8, 120]),
        }
    });
    image.save(&file).unwrap();
    file
}

#[test]
fn the_camera_looks_around_its_room() {
    let output = temporary("seen.png");
    let ended = run("camera", &["--output", text(&output), "--resolution", "vga"]);
    assert_outcome(&ended, "seen");
    assert_eq!(image::open(&output).unwrap().into_rgb8().dimensions(), (640, 480));
    let bright = |options: &[&str]| {
        let ended = run("camera", options);
        assert_outcome(&ended, "seen");
        ended.1["mean_brightness"].as_f64().unwrap()
    };
    let whole = bright(&["--noise", "0"]);
    assert!((bright(&["--noise", "0", "--light", "0.5"]) - 0.5 * whole).abs() < 1.0);
    assert_ne!(whole, bright(&["--noise", "0", "--pan", "30", "--tilt", "-10"]));
    let (status, _, err) = run("camera", &["--pan", "120"]);
    assert!(status == 2 && err.contains("at most 90 degrees"), "{err}");
}

#[test]
fn every_kernel_works_on_a_file() {
    let (input, output) = (squares("squares.png"), temporary("filtered.png"));
    let second = squares("squares2.png");
    for kernel in edges::Kernel::value_variants() {
        for definition in ["book", "opencv"] {
            let name = kernel.name();
            let options = [
                "--input",
                text(&input),
                "--kernel",
                &name,
                "--definition",
                definition,
                "--output",
                text(&output),
                "--repeat",
                "1",
            ];
            let two = ["--second", text(&second)];
            let of_two = ["difference", "overlay"].contains(&name.as_str());
            let ended = run("edges", &[&options[..], if of_two { &two } else { &[] }].concat());
            assert_outcome(&ended, "filtered");
            assert_eq!((ended.1["width"].as_u64(), ended.1["height"].as_u64()), (Some(96), Some(64)));
            let written = image::open(&output).unwrap();
            assert!(written.width() > 0, "{name}");
        }
    }
}

#[test]
fn definitions_differ_where_they_should() {
    let input = squares("squares3.png");
    let mean = |kernel: &str, definition: &str| {
        let options =
            ["--input", text(&input), "--kernel", kernel, "--definition", definition, "--repeat", "1"];
        run("edges", &options).1["mean"].as_f64().unwrap()
    };
    for kernel in ["gray", "sobel_l1", "hue", "saturation"] {
        assert_ne!(mean(kernel, "book"), mean(kernel, "opencv"), "{kernel}");
    }
}

#[test]
fn wrong_images_are_refused_by_name() {
    let file = temporary("no_image.png");
    std::fs::write(&file, b"\x89PNG\r\n\x1a\nthat was all").unwrap();
    for (options, message) in [
        (vec!["--input", text(&file)], "no_image.png"),
        (vec!["--input", "no/such/file.png"], "no/such/file.png"),
        (vec!["--input", text(&file), "--kernel", "nose"], "nose"),
        (vec!["--kernel", "difference"], "--second"),
        (vec!["--smooth", "4"], "0, 3, 5 or 7"),
        (vec!["--kernel", "saturation", "--smooth", "5"], "--smooth"),
        (vec!["--kernel", "threshold", "--threshold", "300"], "--threshold"),
        (vec!["--kernel", "hue", "--exact", "--definition", "opencv"], "--exact"),
        (
            vec!["--kernel", "hue_match", "--hue-low", "200", "--hue-high", "10", "--definition", "opencv"],
            "--hue-low",
        ),
        (vec!["--kernel", "canny", "--low", "200"], "--low"),
        (vec!["--kernel", "hough", "--rho", "-1"], "--rho"),
        (vec!["--low", "-5"], "--low"),
        (vec!["--picture", "edges.svg"], "--output"),
        (vec!["--input", "some.png", "--world", "some.sim"], "--world"),
    ] {
        let (status, _, err) = run("edges", &options);
        assert!(status == 2 && err.contains(message) && err.lines().count() == 1, "{err}");
    }
    let truncated = temporary("truncated.ppm");
    std::fs::write(&truncated, b"P6\n10 10\n255\nabc").unwrap();
    let (status, _, err) = run("edges", &["--input", text(&truncated)]);
    assert!(status == 2 && err.contains("truncated.ppm"), "{err}");
}

#[test]
fn deep_images_keep_their_upper_bytes() {
    let (input, output) = (temporary("deep.png"), temporary("shallow.png"));
    let deep = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(256, 2, |x, y| {
        image::Luma([(x * 256 + 255 * y) as u16])
    });
    deep.save(&input).unwrap();
    let options = ["--input", text(&input), "--kernel", "gray_to_rgb", "--output", text(&output)];
    assert_outcome(&run("edges", &options), "filtered");
    let shallow = image::open(&output).unwrap().into_rgb8();
    // RoBIOS's gray of three equal channels is up to one level lower.
    let near = |x: u32, pixel: &image::Rgb<u8>| x.abs_diff(u32::from(pixel.0[0])) <= 1;
    assert!(shallow.enumerate_pixels().all(|(x, _, pixel)| near(x, pixel)));
    let row = |y: u32| (0..256).map(|x| *shallow.get_pixel(x, y)).collect::<Vec<_>>();
    assert_eq!(row(0), row(1));
}

#[test]
fn images_are_written_whole_in_the_format_of_their_names() {
    let input = squares("squares4.png");
    for (kernel, name, begins) in [("gray", "shades.pgm", "P5"), ("gray_to_rgb", "colours.ppm", "P6")] {
        let output = temporary(name);
        let options =
            ["--input", text(&input), "--kernel", kernel, "--output", text(&output), "--repeat", "1"];
        assert_outcome(&run("edges", &options), "filtered");
        assert!(std::fs::read(&output).unwrap().starts_with(begins.as_bytes()), "{name}");
    }
    if cfg!(target_os = "linux") {
        let full = temporary("full.png");
        let _ = std::fs::remove_file(&full);
        #[cfg(unix)]
        std::os::unix::fs::symlink("/dev/full", &full).unwrap();
        let (status, _, err) = run("edges", &["--input", text(&input), "--output", text(&full)]);
        assert!(status == 2 && err.contains("full.png"), "{status} {err}");
    }
}

#[test]
fn edges_live_on_the_display() {
    let output = temporary("display.png");
    for kernel in ["laplace", "canny", "overlay"] {
        let options = ["--kernel", kernel, "--repeat", "5", "--output", text(&output)];
        let ended = run("edges", &options);
        assert_outcome(&ended, "shown");
        assert_eq!(ended.1["frames"], 5);
        assert!(image::open(&output).unwrap().into_rgb8().iter().any(|&byte| byte > 100));
    }
}

#[test]
fn the_taught_colour_is_reached_and_brought_home() {
    for options in [&["--seed", "1"][..], &["--seed", "2", "--method", "histogram", "--light", "0.4"]] {
        let ended = run("color_tracking", options);
        assert_outcome(&ended, "reached");
        assert!(ended.1["distance_mm"].as_f64().unwrap() < 200.0, "{}", ended.1);
        assert_eq!(ended.1["collisions"], 0);
    }
    let ended = run("color_tracking", &["--job", "home", "--seed", "4"]);
    assert_outcome(&ended, "home");
    assert!(ended.1["home_mm"].as_f64().unwrap() < 200.0, "{}", ended.1);
}

#[test]
fn a_few_scenes_of_the_colour_campaign() {
    let ended = run("color_tracking", &["--campaign", "--scenes", "6"]);
    assert_outcome(&ended, "passed");
    assert_eq!((ended.1["scenes"].as_u64(), ended.1["reached"].as_u64()), (Some(6), Some(6)));
}

#[test]
fn campaigns_refuse_what_they_have_no_use_for() {
    for option in
        [&["--world", "none.sim"][..], &["--start", "1,2,3"], &["--picture", "a.svg"], &["--fault", "lost@1"]]
    {
        let options = [&["--campaign"], option].concat();
        for (status, _, err) in [run("color_tracking", &options), run("motion", &options)] {
            assert!(status == 2 && err.contains(option[0]) && err.lines().count() == 1, "{err}");
        }
    }
    let (status, _, err) = run("color_tracking", &["--campaign", "--light", "1"]);
    assert!(status == 2 && err.contains("--light"), "{err}");
    let (status, _, err) = run("color_tracking", &["--light", "0"]);
    assert!(status == 2 && err.contains("--light"), "{err}");
}

#[test]
fn motion_is_seen_where_it_is() {
    let moving = run("motion", &["--time-limit", "4"]);
    assert_outcome(&moving, "watched");
    assert!(moving.1["alarms"].as_u64().unwrap() > 10, "{}", moving.1);
    let still = run("motion", &["--time-limit", "4", "--still"]);
    assert_outcome(&still, "watched");
    assert_eq!(
        (still.1["alarms"].as_u64(), still.1["turned_deg"].as_f64()),
        (Some(0), Some(0.0)),
        "{}",
        still.1
    );
}

#[test]
fn a_robot_drives_to_what_moves() {
    let ended = run("motion", &["--approach"]);
    assert_outcome(&ended, "reached");
    assert!(ended.1["distance_mm"].as_f64().unwrap() < 600.0, "{}", ended.1);
    let still = run("motion", &["--approach", "--still", "--time-limit", "3"]);
    assert_eq!(
        (still.1["outcome"].as_str(), still.1["alarms"].as_u64()),
        (Some("timed_out"), Some(0)),
        "{}",
        still.1
    );
}

#[test]
fn a_short_campaign_of_approaches_passes() {
    let ended = run("motion", &["--approach", "--campaign", "--scenes", "10"]);
    assert_outcome(&ended, "passed");
    let (status, _, err) = run("motion", &["--scenes", "10"]);
    assert!(status == 2 && err.contains("--scenes"), "{err}");
}

#[test]
fn a_short_motion_campaign_passes() {
    let ended = run("motion", &["--campaign", "--pairs", "200"]);
    assert_outcome(&ended, "passed");
    let book = ended.1["book"]["detected"].as_f64().unwrap();
    assert!(book < ended.1["detected"].as_f64().unwrap(), "{}", ended.1);
}

#[test]
fn looking_ends_at_its_limit() {
    let cases: [(&str, &[&str], f64); 5] = [
        ("edges", &["--kernel", "sobel_l1", "--repeat", "20", "--time-limit", "0.5"], 0.5),
        ("camera", &["--time-limit", "0.1"], 0.1),
        ("camera", &["--pan", "30", "--time-limit", "3"], 3.0),
        ("lidar_scan", &["--time-limit", "0.0001"], 0.01),
        ("localise", &["--time-limit", "1"], 1.0),
    ];
    for (command, options, limit) in cases {
        let (status, report, err) = run(command, options);
        assert_eq!((status, report["outcome"].as_str()), (1, Some("timed_out")), "{command}: {report} {err}");
        assert!(report["sim_time_s"].as_f64().unwrap() <= limit + 1e-9, "{command}: {report}");
    }
}

#[test]
fn a_stopped_clock_ends_looking() {
    let (status, report, _) = run("edges", &["--kernel", "sobel_l1", "--repeat", "30", "--fault", "clock@2"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(report["error"].as_str().unwrap().contains("stands still"), "{report}");
}
