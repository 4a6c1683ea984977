use image::RgbImage;
use roverlab::drive::colour::{
    ColourOutcome, ColourTracker, ColourTrackerParameters, PushHome, PushHomeParameters, PushOutcome,
};
use roverlab::geometry::Point;
use roverlab::io::control::run;
use roverlab::io::{
    self, Camera, Clock, Display, DisplayImage, Drive, ErrorKind, Lidar, Odometry, Pixel, StallDetector,
    Viewport,
};
use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod, Sighting, teach_hue};
use roverlab::world::Colour;

use super::Job;

/// Options of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Options {
    pub(crate) job: Job,
    pub(crate) method: FindMethod,
    pub(crate) tolerance: u8,
    pub(crate) camera: CameraGeometry,
    pub(crate) radius: f64,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// Outcome of a run from the robot's perspective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ended {
    Reached,
    Home,
    TimedOut,
    Blocked,
}

/// The hue of the object in front of the camera.
pub(crate) fn teach(robot: &mut (impl Camera + Display + io::Keys)) -> io::Result<Option<u8>> {
    robot.set_menu(["TEACH", "", "", ""])?;
    robot.wait_key()?;
    let image = robot.image()?;
    robot.draw_image(DisplayImage::Rgb(&image), Viewport::default())?;
    teach_hue(&image, ColourFinder::LIMITS).map_err(|error| failure(&error))
}

fn failure(error: &roverlab::vision::ImageError) -> io::Error {
    io::Error::new(ErrorKind::Other, error.to_string())
}

/// Drives by a hue. `watch` is called after each step.
pub(crate) fn drive<R: Camera + Clock + Display + Drive + Odometry + StallDetector + Lidar + ?Sized>(
    robot: &mut R,
    hue: u8,
    options: &Options,
    mut watch: impl FnMut(),
) -> io::Result<Ended> {
    let finder = ColourFinder::new(hue, options.tolerance, options.method, options.camera)
        .map_err(|error| failure(&error))?;
    match options.job {
        Job::Reach => {
            let parameters =
                ColourTrackerParameters { radius: options.radius, ..ColourTrackerParameters::default() };
            let mut tracker = ColourTracker::new(finder, parameters)?;
            let outcome = run(robot, &mut tracker, options.time_limit, |robot, tracker, step| {
                watch();
                show(robot, &step.seen.image, tracker.sighting())
            })?;
            Ok(match outcome {
                ColourOutcome::Reached => Ended::Reached,
                ColourOutcome::TimedOut | ColourOutcome::Stopped => Ended::TimedOut,
                ColourOutcome::Blocked => Ended::Blocked,
            })
        }
        Job::Home => {
            let defaults = PushHomeParameters::default();
            let tracker = ColourTrackerParameters { radius: options.radius, ..defaults.tracker };
            let home = robot.pose()?.position();
            let mut push = PushHome::new(finder, home, PushHomeParameters { tracker, ..defaults })?;
            let outcome = run(robot, &mut push, options.time_limit, |_, _, _| watch())?;
            Ok(match outcome {
                PushOutcome::Home => Ended::Home,
                PushOutcome::TimedOut | PushOutcome::Stopped => Ended::TimedOut,
                PushOutcome::Blocked => Ended::Blocked,
            })
        }
    }
}

/// Shows the image on the display, with a line at the object's column.
fn show<R: Display + ?Sized>(robot: &mut R, image: &RgbImage, seen: Option<Sighting>) -> io::Result<()> {
    robot.draw_image(DisplayImage::Rgb(image), Viewport::default())?;
    let Some(seen) = seen else { return Ok(()) };
    let column = (seen.column * 320.0 / f64::from(image.width().max(1))) as i32;
    let at = |row: i32| -> Pixel { (column, row) };
    robot.draw_line(at(0), at(239), Colour::GREEN)
}

/// Distance of the nearest of several places.
pub(crate) fn nearest(places: impl IntoIterator<Item = Point>, to: Point) -> Option<f64> {
    places.into_iter().map(|place| (place - to).norm()).reduce(f64::min)
}
