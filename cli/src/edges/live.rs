//! A kernel on the robot's camera images, shown on its display.

use image::{DynamicImage, RgbImage};
use roverlab::geometry::Twist;
use roverlab::io::control::{self, until};
use roverlab::io::{self, Camera, Clock, Display, DisplayImage, Drive, Resolution, Viewport};

use super::checks::refused;
use super::kernel::{Kernel, Runner};
use super::{Args, file};
use crate::common::{Failure, Outcome, Report};
use crate::driving::{Conditions, Looking, in_time, paced};

/// Time between two images (s).
const PERIOD: f64 = 0.1;

pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.kernel.needs_second() || args.second.is_some() {
        return Err(Failure::input("--second: found no --input; expected an image file to compare with"));
    }
    let common = &args.common;
    let scene = common.placed(crate::room::scene)?;
    let conditions = Conditions::new(common, f64::from(args.repeat) * PERIOD + 1.0)?;
    let mut runner = Runner::new(args).map_err(|error| refused(&error))?;
    // Wrong options show before the robot moves.
    let (width, height) = Resolution::Qvga.dimensions();
    runner.run(&RgbImage::new(width, height), None).map_err(|error| refused(&error))?;
    let mut frames = 0;
    let run = conditions.run(&scene, paced(common), |robot, step| {
        let mut count = || {
            frames += 1;
            step();
        };
        show(robot, &mut runner, (args.repeat, conditions.time_limit), &mut count)
    })?;
    let mut report = run.report(|_| Outcome::verdict("shown"));
    let output = args.output.clone().or_else(|| common.unnamed_file("edges.png"));
    if let (Ok(shown), Some(output)) = (&run.ending, &output) {
        file::save(&DynamicImage::from(shown.clone()), output)?;
        common.tell(format_args!("image: {}", output.display()));
    }
    let (width, height) = run.ending.as_ref().map_or((0, 0), RgbImage::dimensions);
    report = report
        .field("kernel", args.kernel.name())
        .field("definition", args.definition.name())
        .field("width", width)
        .field("height", height)
        .field("output", output)
        .field("frames", frames);
    Ok(report)
}

/// Turns on the spot and shows a number of images within a time limit (s). Returns the final display.
fn show(
    robot: &mut (impl Camera + Clock + Display + Drive),
    runner: &mut Runner,
    (images, limit): (u32, f64),
    step: &mut dyn FnMut(),
) -> io::Result<RgbImage> {
    let velocity = Twist::new(0.0, 0.4);
    let mut turning = Looking { resolution: Resolution::Qvga, period: PERIOD, velocity };
    let mut left = images;
    let halt = control::run(robot, &mut turning, limit, |robot, _, at| {
        let processed = runner
            .run(at.seen, None)
            .map_err(|error| io::Error::new(io::ErrorKind::Other, error.to_string()).with_source(error))?;
        match &processed.image {
            DynamicImage::ImageLuma8(gray) if runner.kernel != Kernel::Hog => {
                robot.draw_image(DisplayImage::Gray(gray), Viewport::default())?;
            }
            other => robot.draw_image(DisplayImage::Rgb(&other.to_rgb8()), Viewport::default())?,
        }
        step();
        left -= 1;
        io::Result::Ok(until(left == 0))
    })?;
    in_time(halt)?;
    robot.screenshot()
}
