use parry2d_f64::math::{Pose as ParryPose, Vector as ParryVector};
use parry2d_f64::shape::{Shape as ParryShape, SharedShape, TypedShape};

use super::{Object, ObjectKind, Shape, Wall, World};
use crate::geometry::{Point, Pose, Segment, math};
use crate::parameter::debug_as_sentence;

/// A `parry2d` shape without an equivalent in a world.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "found a {found}; expected segments, polylines, triangles, polygons, cuboids, balls or compounds of them"
)]
pub struct ParryError {
    found: String,
}

debug_as_sentence!(ParryError);

impl World {
    /// Contents of the world at a height (m) as `parry2d` shapes with poses: a cuboid for each wall and box,
    /// a segment for each wall of zero thickness, a ball for each round object. Hills are left out.
    ///
    /// ```
    /// use parry2d_f64::math::Vector;
    /// use parry2d_f64::query::{Ray, RayCast};
    /// use parry2d_f64::shape::Compound;
    /// use roverlab::world::World;
    /// let room = World::walled(2.0, 1.0);
    /// let compound = Compound::new(room.parry_shapes(0.1));
    /// let ray = Ray::new(Vector::new(0.5, 0.5), Vector::new(1.0, 0.0));
    /// let range = compound.cast_local_ray(&ray, 10.0, true).expect("a wall");
    /// assert!((range - 1.495).abs() < 1e-9, "to the face of a wall of 10 mm: {range} m");
    /// // And back:
    /// let mut again = World::empty(2.0, 1.0);
    /// again.add_parry_shape(Default::default(), &compound)?;
    /// assert_eq!(again.walls.len(), room.walls.len());
    /// # Ok::<(), roverlab::world::ParryError>(())
    /// ```
    pub fn parry_shapes(&self, height: f64) -> Vec<(ParryPose, SharedShape)> {
        let walls = self.walls.iter().filter(|wall| (0.0..=wall.height).contains(&height)).map(wall_shape);
        let objects = self.objects.iter().filter_map(|object| {
            let pose = ParryPose::new(vector(object.pose.position()), object.pose.heading);
            Some((pose, section(&object.kind.shape, height)?))
        });
        walls.chain(objects).collect()
    }

    /// Adds a `parry2d` shape: segments and polygon edges become walls of zero thickness, cuboids become
    /// walls along their longer side, and balls become cylinders. Walls and cylinders have the default height
    /// of walls.
    ///
    /// # Errors
    /// For any other shape; walls and objects added before the error remain.
    pub fn add_parry_shape(&mut self, pose: ParryPose, shape: &dyn ParryShape) -> Result<(), ParryError> {
        let place = |local: ParryVector| point(pose * local);
        match shape.as_typed_shape() {
            TypedShape::Segment(segment) => self.add_edge(place(segment.a), place(segment.b)),
            TypedShape::Polyline(line) => {
                line.segments().for_each(|segment| self.add_edge(place(segment.a), place(segment.b)));
            }
            TypedShape::Triangle(triangle) => {
                self.add_outline(&[triangle.a, triangle.b, triangle.c].map(place));
            }
            TypedShape::ConvexPolygon(polygon) => {
                let corners: Vec<Point> = polygon.points().iter().map(|&corner| place(corner)).collect();
                self.add_outline(&corners);
            }
            TypedShape::Cuboid(cuboid) => {
                let half = cuboid.half_extents;
                let (along, across) = if half.x < half.y {
                    (ParryVector::new(0.0, half.y), half.x)
                } else {
                    (ParryVector::new(half.x, 0.0), half.y)
                };
                let line = Segment::new(place(-along), place(along));
                self.walls.push(Wall { line, thickness: 2.0 * across, ..Wall::new(line.a, line.b) });
            }
            TypedShape::Ball(ball) => {
                let shape = Shape::Cylinder { radius: ball.radius, height: Wall::DEFAULT_HEIGHT };
                let kind = ObjectKind::new("ball", shape, Wall::DEFAULT_COLOUR);
                let at = place(ParryVector::new(0.0, 0.0));
                self.objects.push(Object::new(kind.into(), Pose::new(at.x, at.y, 0.0)));
            }
            TypedShape::Compound(compound) => {
                for (part, shape) in compound.shapes() {
                    self.add_parry_shape(pose * *part, &**shape)?;
                }
            }
            _ => return Err(ParryError { found: format!("{:?}", shape.shape_type()) }),
        }
        Ok(())
    }

    fn add_edge(&mut self, a: Point, b: Point) {
        self.walls.push(Wall { thickness: 0.0, ..Wall::new(a, b) });
    }

    fn add_outline(&mut self, corners: &[Point]) {
        for (index, &corner) in corners.iter().enumerate() {
            self.add_edge(corner, corners[(index + 1) % corners.len()]);
        }
    }
}

/// A wall with its thickness, in the frame of its centre.
fn wall_shape(wall: &Wall) -> (ParryPose, SharedShape) {
    let Segment { a, b } = wall.line;
    if wall.thickness == 0.0 {
        return (ParryPose::default(), SharedShape::segment(vector(a), vector(b)));
    }
    let along = b - a;
    let pose = ParryPose::new(vector(nalgebra::center(&a, &b)), math::atan2(along.y, along.x));
    (pose, SharedShape::cuboid(0.5 * along.norm(), 0.5 * wall.thickness))
}

/// Section of a shape at a height above its foot; `None` outside of its height.
fn section(shape: &Shape, height: f64) -> Option<SharedShape> {
    if !(0.0..=shape.height()).contains(&height) {
        return None;
    }
    Some(match *shape {
        Shape::Cylinder { radius, .. } => SharedShape::ball(radius),
        Shape::Cone { radius, top, height: whole } => {
            SharedShape::ball(radius + (top - radius) * height / whole)
        }
        Shape::Sphere { radius } => SharedShape::ball((height * (2.0 * radius - height)).sqrt()),
        Shape::Box { length, width, .. } => SharedShape::cuboid(0.5 * length, 0.5 * width),
    })
}

fn vector(point: Point) -> ParryVector {
    ParryVector::new(point.x, point.y)
}

fn point(vector: ParryVector) -> Point {
    Point::new(vector.x, vector.y)
}
