use std::f64::consts::{FRAC_PI_2, PI};

use super::canvas::Canvas;
use super::scenery::Scenery;
use super::view::{Place, View};
use crate::geometry::math;
use crate::io::Result;
use crate::io::sim::terrain::Hills;
use crate::world::space::Space;

/// An equidistant lens: the distance of an image point from the centre is proportional to its angle from the
/// line of sight.
///
/// Straight lines become curves, so the scene is drawn on the flat sides of an upright cube about the camera,
/// which are then sampled through the lens.
#[derive(Debug)]
pub(super) struct Fisheye {
    /// Width and height of the picture, the angle across it, tilt and roll, for which the sides were worked
    /// out.
    of: (usize, usize, f64, f64, f64),
    /// Pixels along each edge of the cube.
    edge: usize,
    /// For each side of the cube, the picture's pixels that show it and the corresponding pixels of the side.
    sides: [Vec<(u32, u32)>; SIDES.len()],
}

/// Sides of the cube as angles to the left of the camera's heading and up.
const SIDES: [(f64, f64); 6] =
    [(0.0, 0.0), (FRAC_PI_2, 0.0), (PI, 0.0), (-FRAC_PI_2, 0.0), (0.0, FRAC_PI_2), (0.0, -FRAC_PI_2)];
/// Pixels of a side per pixel of the picture at its centre.
const FINENESS: f64 = 1.25;
/// Largest number of pixels along an edge.
const LONGEST_EDGE: f64 = 2048.0;

/// Position and direction of a camera with such a lens.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gaze {
    pub(super) eye: Place,
    pub(super) heading: f64,
    pub(super) tilt: f64,
    /// Radians by which its left side is lifted.
    pub(super) roll: f64,
    /// Radians from the picture's left edge to its right one.
    pub(super) field_of_view: f64,
    pub(super) dimensions: (u32, u32),
}

impl Fisheye {
    pub(super) fn new() -> Self {
        Self { of: (0, 0, 0.0, 0.0, 0.0), edge: 0, sides: [const { Vec::new() }; SIDES.len()] }
    }

    /// Draws the view of a robot's camera. `side` is a buffer.
    pub(super) fn draw(
        &mut self,
        (picture, side): (&mut Canvas, &mut Canvas),
        scenery: &mut Scenery,
        gaze: &Gaze,
        (space, hills): (&Space, Option<&Hills>),
        me: usize,
    ) -> Result<()> {
        let (width, height) = (gaze.dimensions.0 as usize, gaze.dimensions.1 as usize);
        let of = (width, height, gaze.field_of_view, gaze.tilt, gaze.roll);
        if self.of != of {
            self.work_out(of);
        }
        picture.reset(width, height);
        // Directions beyond 180 degrees stay black.
        picture.colours.fill(0);
        for (pixels, (left, up)) in self.sides.iter().zip(SIDES) {
            if pixels.is_empty() {
                continue;
            }
            let dimensions = (self.edge as u32, self.edge as u32);
            let view = View::new(gaze.eye, gaze.heading + left, up, FRAC_PI_2, dimensions);
            scenery.draw(side, &view, (space, hills), me)?;
            for &(shown, from) in pixels {
                picture.colours[shown as usize] = side.colours[from as usize];
            }
        }
        Ok(())
    }

    /// Finds which pixel of which side each pixel of the picture shows.
    fn work_out(&mut self, of: (usize, usize, f64, f64, f64)) {
        let (width, height, field_of_view, tilt, roll) = of;
        let (sin, cos) = math::sin_cos(roll);
        let focal = width as f64 / field_of_view;
        let edge = (2.0 * FINENESS * focal).ceil().clamp(2.0, LONGEST_EDGE);
        (self.of, self.edge) = (of, edge as usize);
        self.sides.iter_mut().for_each(Vec::clear);
        let dimensions = (edge as u32, edge as u32);
        let views = SIDES.map(|(left, up)| View::new([0.0; 3], left, up, FRAC_PI_2, dimensions));
        let last = edge - 1.0;
        for row in 0..height {
            for column in 0..width {
                let right = (column as f64 + 0.5 - 0.5 * width as f64) / focal;
                let down = (row as f64 + 0.5 - 0.5 * height as f64) / focal;
                let (right, down) = (right * cos - down * sin, down * cos + right * sin);
                let Some(ray) = ray(right, down, tilt) else { continue };
                let seen = views.map(|view| view.turned(ray));
                let nearest =
                    (0..SIDES.len()).fold(0, |best, i| if seen[i].z > seen[best].z { i } else { best });
                let (x, y) = views[nearest].project(seen[nearest]);
                let from = y.clamp(0.0, last) as usize * self.edge + x.clamp(0.0, last) as usize;
                self.sides[nearest].push(((row * width + column) as u32, from as u32));
            }
        }
    }
}

/// Direction (ahead, left, up) of a picture point at angles to the right and down, for a camera tilted up by
/// `tilt`; `None` beyond straight behind it.
fn ray(right: f64, down: f64, tilt: f64) -> Option<Place> {
    let angle = math::hypot(right, down);
    if angle > PI {
        return None;
    }
    let (sin, ahead) = math::sin_cos(angle);
    let share = if angle > 0.0 { sin / angle } else { 1.0 };
    let (aside, up) = (share * right, -share * down);
    let (sin, cos) = math::sin_cos(tilt);
    Some([cos * ahead - sin * up, -aside, sin * ahead + cos * up])
}
