//! Samples of types that cannot be made of their public fields or by a constructor.

mod craft;
mod learned;
mod logs;
mod race;

use image::{GrayImage, ImageBuffer, RgbImage, RgbaImage};
use nalgebra::{Point2, Point3, UnitQuaternion, Vector2, Vector3};

use crate::sample::samples;
use roverlab::geometry::{Point, Pose, Segment, direction};
use roverlab::io::sim::{SimOptions, Simulation, Truth};
use roverlab::vision::{GrayView, GrayViewMut, RgbView, RgbViewMut};
use roverlab::world::{RobotSpec, Scene, Wall, World};

samples! {
    Point2<f64> => [
        Point2::new(1.0, 0.5), Point2::new(f64::NAN, 0.0), Point2::new(0.0, f64::INFINITY), Point2::origin(),
        Point2::new(-1e300, 1e300), Point2::new(1e9, 0.0), Point2::new(1.0, -1e-300)
    ], list (0..12).map(|k| Point2::origin() + direction(f64::from(k) * 0.52) * 5.0).collect();
    Vector2<f64> => [
        Vector2::new(1.0, 0.5), Vector2::new(f64::NAN, 0.0), Vector2::zeros(), Vector2::new(-1e300, f64::INFINITY)
    ];
    Point3<f64> => [
        Point3::new(1.0, 0.5, 0.2), Point3::new(f64::NAN, 0.0, 0.0), Point3::new(1e300, f64::INFINITY, -1e300)
    ];
    Vector3<f64> => [
        Vector3::new(1.0, 0.5, 0.2), Vector3::new(f64::NAN, 0.0, 0.0), Vector3::zeros(),
        Vector3::new(1e300, f64::INFINITY, -1e300)
    ];
    UnitQuaternion<f64> => [UnitQuaternion::identity(), UnitQuaternion::from_euler_angles(3.0, -2.0, 1.0)];
}

/// A room with one more wall.
fn room_with_wall(a: Point, b: Point) -> World {
    let mut world = World::walled(3.0, 2.0);
    world.walls.push(Wall { line: Segment::new(a, b), ..world.walls[0] });
    world
}

fn pattern<P: image::Pixel<Subpixel = u8>>(width: u32, height: u32) -> ImageBuffer<P, Vec<u8>> {
    let length = (width * height) as usize * usize::from(P::CHANNEL_COUNT);
    let data = (0..length).map(|k| (k * 37 % 251) as u8).collect();
    ImageBuffer::from_raw(width, height, data).expect("as many pixels")
}

samples! {
    World => [
        room_with_wall(Point::new(1.0, 1.5), Point::new(2.0, 1.5)),
        World::empty(1.0, 1.0),
        room_with_wall(Point::new(f64::NAN, 1.0), Point::new(1.0, 1.0)),
        room_with_wall(Point::new(1e3, 0.0), Point::new(1e3, 1.0)),
        room_with_wall(Point::new(1e6, 0.0), Point::new(1e6, 1.0)),
        room_with_wall(Point::new(0.0, 0.0), Point::new(1e160, 1.0)),
        World { walls: Vec::new(), ..World::walled(1e9, 1e9) }
    ];
    Scene => [
        Scene::with_robot(World::nth(0)?, RobotSpec::labbot(), Pose::new(1.0, 1.0, 0.3)),
        Scene::new(World::nth(0)?),
        Scene::with_robot(World::nth(5)?, RobotSpec::s4(), Pose::new(1.0, 1.0, f64::NAN)),
        Scene::with_robot(World::nth(1)?, RobotSpec::s4(), Pose::new(1e300, 1.0, 0.0))
    ];
    Simulation => [Simulation::new(&Scene::nth(0)?, SimOptions::default()).ok()?];
    Truth => [Simulation::nth(0)?.truth()];
    GrayImage => [pattern(16, 12), pattern(1, 1), pattern(0, 0), pattern(0, 3), pattern(300, 1)];
    RgbImage => [pattern(16, 12), pattern(1, 1), pattern(0, 0), pattern(0, 3), pattern(300, 1)];
    RgbaImage => [pattern(16, 12), pattern(1, 1), pattern(0, 0)];
    GrayBuffer => [GrayBuffer(pattern(16, 12)), GrayBuffer(pattern(3, 2)), GrayBuffer(pattern(1, 1)), GrayBuffer(pattern(300, 1))];
    RgbBuffer => [RgbBuffer(pattern(16, 12)), RgbBuffer(pattern(3, 2)), RgbBuffer(pattern(1, 1)), RgbBuffer(pattern(300, 1))];
}

/// The pixels behind a grey view.
#[derive(Debug)]
pub(crate) struct GrayBuffer(GrayImage);

impl GrayBuffer {
    /// As it is.
    pub(crate) fn view(&self) -> GrayView<'_> {
        GrayView::new(&self.0, self.0.width() as usize, self.0.height() as usize).expect("a view")
    }

    /// To be written to.
    pub(crate) fn view_mut(&mut self) -> GrayViewMut<'_> {
        let (width, height) = (self.0.width() as usize, self.0.height() as usize);
        GrayViewMut::new(&mut self.0, width, height).expect("a view")
    }
}

/// The pixels behind a coloured view.
#[derive(Debug)]
pub(crate) struct RgbBuffer(RgbImage);

impl RgbBuffer {
    /// As it is.
    pub(crate) fn view(&self) -> RgbView<'_> {
        RgbView::new(&self.0, self.0.width() as usize, self.0.height() as usize).expect("a view")
    }

    /// To be written to.
    pub(crate) fn view_mut(&mut self) -> RgbViewMut<'_> {
        let (width, height) = (self.0.width() as usize, self.0.height() as usize);
        RgbViewMut::new(&mut self.0, width, height).expect("a view")
    }
}
