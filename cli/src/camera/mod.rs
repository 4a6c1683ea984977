//! The command `camera`.

use std::path::PathBuf;

use image::RgbImage;
use roverlab::geometry::{Pose, Twist, direction};
use roverlab::io::control::{self, until};
use roverlab::io::{self, Camera, Clock, Display, DisplayImage, Drive, Resolution, Servos, Viewport};
use roverlab::picture::{Picture, Style};
use roverlab::vision::{GrayView, GrayViewMut, GrayWeights, ImageError, gray_into};

use crate::common::{CommonArgs, Failure, Outcome, Report, Stopwatch, rounded, write_image};
use crate::driving::{Conditions, Looking, Run, in_time, paced, pale};
use crate::room;
use roverlab::world::Scene;

/// Command line of `camera`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Takes images with the robot's camera and shows them on its display",
    after_help = "\
Without --world, the robot is in a room with several objects. Pan counts to the left and tilt upwards; the head turns at
30 degrees per second.

JSON fields:
  width, height, images
  output                      file of the last image, or null
  mean_brightness             of the last image, 0 to 255
  timing                      with --timing: images_per_s
  picture
Outcomes: seen, collided, timed_out, failed."
)]
pub(crate) struct Args {
    /// Size of the images.
    #[arg(long, value_enum, default_value = "qvga")]
    pub(crate) resolution: Size,

    /// Pan angle of the camera's head, to the left (degrees).
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) pan: f64,

    /// Tilt angle, upwards (degrees).
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) tilt: f64,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Number of images to take.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) images: u32,

    /// File for the last image: .png, .ppm or .bmp [target/pictures/camera.png, unless --json].
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal", "animation"]),
]);

/// Image size by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Size {
    /// 160 x 120.
    Qqvga,
    /// 320 x 240.
    Qvga,
    /// 640 x 480.
    Vga,
    /// 1296 x 730.
    Cam1mp,
    /// 1920 x 1080.
    Camhd,
    /// 2592 x 1944.
    Cam5mp,
}

impl From<Size> for Resolution {
    fn from(size: Size) -> Self {
        match size {
            Size::Qqvga => Self::Qqvga,
            Size::Qvga => Self::Qvga,
            Size::Vga => Self::Vga,
            Size::Cam1mp => Self::Cam1Mp,
            Size::Camhd => Self::CamHd,
            Size::Cam5mp => Self::Cam5Mp,
        }
    }
}

/// The last image, and the wall-clock time of all images (s).
#[derive(Debug, Clone)]
struct Seen {
    image: RgbImage,
    seconds: f64,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed(room::scene)?;
    let head = head(args, &scene)?;
    let limit = 60.0 + f64::from(args.images) * FRAME;
    let conditions = Conditions { light: args.light, reserve: 0.0, ..Conditions::new(common, limit)? };
    let size = args.resolution.into();
    let run = conditions.run(&scene, paced(common), |robot, step| {
        look(robot, size, head, (args.images, conditions.time_limit), step)
    })?;
    let output = save(args, &run)?;
    let seen = run.ending.as_ref().ok();
    let (width, height) = seen.map_or((0, 0), |seen| seen.image.dimensions());
    let report = run
        .report(|_| Outcome::verdict("seen"))
        .field("width", width)
        .field("height", height)
        .field("images", args.images)
        .field("output", output)
        .field("mean_brightness", seen.and_then(|seen| brightness(&seen.image).ok()).map(rounded))
        .timing(
            "images_per_s",
            seen.map_or(f64::NAN, |seen| f64::from(args.images) / seen.seconds.max(1e-9)),
        );
    Ok(common.draw(report, "camera.svg", || drawing(&scene, run.truth.pose)))
}

/// The scene from above, with the camera's field of view.
fn drawing(scene: &Scene, pose: Pose) -> Picture {
    let spec = &scene.robots[0].spec;
    let mut drawing = Picture::new(&scene.world);
    drawing.title("What the camera has before it");
    if let Some(camera) = spec.camera {
        let half = 0.5 * camera.field_of_view;
        let reach = 0.25 * scene.world.floor.size().max();
        let rim = (-8..=8).map(|i| direction(pose.heading + half * f64::from(i) / 8.0) * reach);
        let corners = std::iter::once(pose.position()).chain(rim.map(|edge| pose.position() + edge));
        drawing.polygon(corners, Style::aid().filled(0.15).labelled("field of view"));
    }
    for other in &scene.robots[1..] {
        drawing.robot_with(other.pose, &other.spec.footprint, pale().labelled("another robot"));
    }
    drawing.robot(pose, &spec.footprint);
    drawing
}

/// Positions of the head's servos for the given angles, whose numbers follow those of the drive.
fn head(args: &Args, scene: &Scene) -> Result<[(u8, f64); 2], Failure> {
    let spec = &scene.robots[0].spec;
    let Some(camera) = spec.camera else {
        return Err(Failure::input(format!(
            "found robot {} without a camera; expected one with a camera",
            spec.name
        )));
    };
    let own = u8::from(matches!(spec.drive, roverlab::world::DriveSpec::Ackermann { .. }));
    let position = |option: &str, degrees: f64, largest: f64| {
        let most = roverlab::geometry::units::to_deg(largest);
        if degrees.abs() <= most {
            // A fixed head stays as it is.
            return Ok(if most == 0.0 { 0.0 } else { degrees / most });
        }
        Err(Failure::input(format!(
            "{option}: found {degrees}; expected at most {most:.0} degrees either way"
        )))
    };
    let pan = -position("--pan", args.pan, camera.max_pan)?;
    let tilt = position("--tilt", args.tilt, camera.max_tilt)?;
    Ok([(own + 1, pan), (own + 2, tilt)])
}

/// Frame period of the simulator's camera (s).
const FRAME: f64 = 1.0 / 30.0;

/// Turns the head, then takes a number of images within a time limit (s), and shows the last one.
fn look(
    robot: &mut (impl Camera + Clock + Display + Drive + Servos),
    size: Resolution,
    head: [(u8, f64); 2],
    (images, limit): (u32, f64),
    step: &mut dyn FnMut(),
) -> io::Result<Seen> {
    if head.iter().any(|&(_, position)| position != 0.0) {
        for (servo, position) in head {
            robot.set_servo(servo, position)?;
        }
        robot.wait(6.0)?;
    }
    let mut image = RgbImage::default();
    let stopwatch = Stopwatch::start();
    let mut still = Looking { resolution: size, period: FRAME, velocity: Twist::STOP };
    let mut left = images;
    let halt = control::run(robot, &mut still, limit, |_, _, at| {
        left -= 1;
        if left == 0 {
            image.clone_from(at.seen);
        }
        until(left == 0)
    })?;
    in_time(halt)?;
    let seconds = stopwatch.seconds();
    robot.draw_image(DisplayImage::Rgb(&image), Viewport::default())?;
    step();
    Ok(Seen { image, seconds })
}

fn brightness(image: &RgbImage) -> Result<f64, ImageError> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let mut gray = vec![0; width * height];
    gray_into(image.try_into()?, GrayViewMut::new(&mut gray, width, height)?, GrayWeights::Rec601)?;
    let black = vec![0; gray.len()];
    roverlab::vision::mean_difference(
        GrayView::new(&gray, width, height)?,
        GrayView::new(&black, width, height)?,
    )
}

/// Writes the last image; with `--json` only on request.
fn save(args: &Args, run: &Run<Seen>) -> Result<Option<PathBuf>, Failure> {
    let unasked = || args.common.unnamed_file("camera.png");
    let (Some(file), Ok(seen)) = (args.output.clone().or_else(unasked), &run.ending) else { return Ok(None) };
    write_image(&seen.image.clone().into(), &file).map_err(|error| {
        Failure::input(format!(
            "--output {}: {error}; expected a file ending in .png, .ppm or .bmp that can be written",
            file.display()
        ))
    })?;
    args.common.tell(format_args!("image: {}", file.display()));
    Ok(Some(file))
}
