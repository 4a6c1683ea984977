use super::{Footprint, Shape};
use crate::geometry::{Aabb, Point};

/// A point in space: metres forwards, to the left and up.
pub type Place3 = [f64; 3];

/// An axis of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axis {
    /// From back to front.
    Forward,
    /// From right to left.
    Left,
    /// Upright.
    #[default]
    Up,
}

/// A solid part of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Collider {
    /// A cuboid along the body's axes.
    Box {
        /// Size along each axis (m).
        size: Place3,
        /// Its centre.
        centre: Place3,
    },
    /// A ball.
    Sphere {
        /// Radius (m).
        radius: f64,
        /// Its centre.
        centre: Place3,
    },
    /// A cylinder with hemispherical ends.
    Capsule {
        /// Radius (m).
        radius: f64,
        /// Total length, including the hemispherical ends (m).
        height: f64,
        /// Direction of its axis.
        axis: Axis,
        /// Its centre.
        centre: Place3,
    },
}

impl Collider {
    /// Extent along each axis.
    pub fn extent(&self) -> [(f64, f64); 3] {
        let (half, centre) = match *self {
            Collider::Box { size, centre } => (size.map(|s| 0.5 * s), centre),
            Collider::Sphere { radius, centre } => ([radius; 3], centre),
            Collider::Capsule { radius, height, axis, centre } => {
                let mut half = [radius; 3];
                half[axis as usize] = 0.5 * height;
                (half, centre)
            }
        };
        [0, 1, 2].map(|i| (centre[i] - half[i], centre[i] + half[i]))
    }

    /// Radius about the upright axis through a point ahead of the origin; `None` if it is not round about
    /// that axis.
    fn round_about(&self, ahead: f64) -> Option<f64> {
        match *self {
            Collider::Sphere { radius, centre }
            | Collider::Capsule { radius, axis: Axis::Up, centre, .. } => {
                (centre[0] == ahead && centre[1] == 0.0).then_some(radius)
            }
            _ => None,
        }
    }
}

/// Data of a description file about the solid of a robot or object, relative to the origin of its 3D model.
///
/// The simulation uses what follows from it: a robot's footprint and height, an object's shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Solid parts in model units, to be multiplied by `scale`. Empty if the footprint or shape is
    /// sufficient.
    pub colliders: Vec<Collider>,
    /// Centre of mass in model units.
    pub mass_centre: Place3,
    /// Size of a model unit (m).
    pub scale: f64,
    /// Offset of the displayed model as in its file: metres to the right, up and forwards.
    pub model_offset: [f64; 3],
    /// Rotation of the displayed model as in its file: radians about its right, up and forward axes.
    pub model_rotation: [f64; 3],
    /// Distance from the model's origin forwards to the driven axle, and up to it (m).
    pub axle: [f64; 2],
    /// Height of the steered axle above the model's origin (m).
    pub turn_axle_height: f64,
}

impl Default for Body {
    fn default() -> Self {
        Self {
            colliders: Vec::new(),
            mass_centre: [0.0; 3],
            scale: 1.0,
            model_offset: [0.0; 3],
            model_rotation: [0.0; 3],
            axle: [0.0; 2],
            turn_axle_height: 0.0,
        }
    }
}

impl Body {
    /// Largest distance from the axle to the farthest side at which a footprint may become a disc (m).
    pub const MAX_DISC: f64 = 0.25;
    /// Required roundness: smallest ratio of the nearest to the farthest side.
    pub const MIN_ROUNDNESS: f64 = 0.8;

    /// Footprint about the driven axle and height above the model's origin, from the colliders; `None`
    /// without colliders.
    ///
    /// A single sphere or upright capsule on the axle is a disc. So is a small, nearly round robot that can
    /// turn on the spot: its farthest side is at most [`Body::MAX_DISC`] away, and its nearest at least
    /// [`Body::MIN_ROUNDNESS`] of that. All others are the bounding rectangle of their colliders.
    pub fn footprint(&self, turns_on_the_spot: bool) -> Option<(Footprint, f64)> {
        let [x, y, z] = self.extent()?;
        let (ahead, top) = (self.axle[0], top(z));
        if let [single] = self.colliders.as_slice()
            && let Some(radius) = single.round_about(ahead)
        {
            return Some((Footprint::Disc { radius }, top));
        }
        let sides = [x.1 - ahead, ahead - x.0, y.1, -y.0];
        let far = sides.into_iter().fold(f64::MIN, f64::max);
        let near = sides.into_iter().fold(f64::MAX, f64::min);
        if turns_on_the_spot && far <= Self::MAX_DISC && near >= Self::MIN_ROUNDNESS * far {
            return Some((Footprint::Disc { radius: far }, top));
        }
        let corners = (Point::new(x.0 - ahead, y.0), Point::new(x.1 - ahead, y.1));
        Some((Footprint::Rectangle(Aabb::new(corners.0, corners.1)), top))
    }

    /// The upright shape about the origin that contains all colliders, from the floor up; `None` without
    /// colliders.
    pub fn shape(&self) -> Option<Shape> {
        let [x, y, z] = self.extent()?;
        let top = top(z);
        if let [single] = self.colliders.as_slice()
            && let Some(radius) = single.round_about(0.0)
        {
            let radius = radius * self.scale;
            let ball = matches!(single, Collider::Sphere { .. });
            return Some(if ball {
                Shape::Sphere { radius }
            } else {
                Shape::Cylinder { radius, height: top }
            });
        }
        let across = |(low, high): (f64, f64)| 2.0 * f64::max(-low, high);
        Some(Shape::Box { length: across(x), width: across(y), height: top })
    }

    /// A single collider equivalent to a footprint and height.
    pub fn collider_of_footprint(&self, footprint: &Footprint, height: f64) -> Collider {
        let (ahead, middle) = (self.axle[0], 0.5 * height);
        match footprint {
            Footprint::Disc { radius } => {
                Collider::Capsule { radius: *radius, height, axis: Axis::Up, centre: [ahead, 0.0, middle] }
            }
            Footprint::Rectangle(b) => Collider::Box {
                size: [b.max.x - b.min.x, b.max.y - b.min.y, height],
                centre: [0.5 * (b.min.x + b.max.x) + ahead, 0.5 * (b.min.y + b.max.y), middle],
            },
        }
    }

    /// A single collider equivalent to a shape.
    pub fn collider_of_shape(shape: Shape) -> Collider {
        let centre = [0.0, 0.0, 0.5 * shape.height()];
        match shape {
            // The file formats have no cones.
            Shape::Cylinder { radius, height } | Shape::Cone { radius, height, .. } => {
                Collider::Capsule { radius, height, axis: Axis::Up, centre }
            }
            Shape::Sphere { radius } => Collider::Sphere { radius, centre },
            Shape::Box { length, width, height } => Collider::Box { size: [length, width, height], centre },
        }
    }

    /// Extent of the colliders along each axis (m).
    fn extent(&self) -> Option<[(f64, f64); 3]> {
        let extents = self.colliders.iter().map(Collider::extent);
        let joined = extents.reduce(|a, b| [0, 1, 2].map(|i| (a[i].0.min(b[i].0), a[i].1.max(b[i].1))))?;
        Some(joined.map(|(low, high)| (low * self.scale, high * self.scale)))
    }
}

/// Height above the model's origin, or total height of a body below it.
fn top((low, high): (f64, f64)) -> f64 {
    if high > 0.0 { high } else { high - low }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;

    fn body(colliders: &[Collider]) -> Body {
        Body { colliders: colliders.to_vec(), ..Body::default() }
    }

    #[test]
    fn nearly_round_robots_that_turn_become_discs() {
        let round = body(&[Collider::Box { size: [0.11, 0.1, 0.08], centre: [0.0, 0.0, 0.04] }]);
        assert_eq!(round.footprint(true), Some((Footprint::Disc { radius: 0.055 }, 0.08)));
        assert!(matches!(round.footprint(false), Some((Footprint::Rectangle(_), _))));
        let long = body(&[Collider::Box { size: [0.2, 0.1, 0.08], centre: [0.0, 0.0, 0.04] }]);
        assert!(matches!(long.footprint(true), Some((Footprint::Rectangle(_), _))));
    }

    #[test]
    fn a_rectangle_stands_about_the_axle() {
        let mut car = body(&[Collider::Box { size: [4.0, 2.0, 1.0], centre: [1.0, 0.0, 0.5] }]);
        car.axle = [-0.5, 0.3];
        let expected = Aabb::new(Point::new(-0.5, -1.0), Point::new(3.5, 1.0));
        assert_eq!(car.footprint(false), Some((Footprint::Rectangle(expected), 1.0)));
    }

    #[test]
    fn scaled_colliders_give_the_shape() {
        let mut pole = body(&[Collider::Capsule {
            radius: 0.15,
            height: 14.2,
            axis: Axis::Up,
            centre: [0.0, 0.0, 7.5],
        }]);
        pole.scale = 0.025;
        let Some(Shape::Cylinder { radius, height }) = pole.shape() else { panic!("no cylinder") };
        assert!((radius - 0.003_75).abs() < 1e-12 && (height - 0.365).abs() < 1e-12);
        let beside = body(&[Collider::Sphere { radius: 1.0, centre: [0.0, 2.0, 1.0] }]);
        assert_eq!(beside.shape(), Some(Shape::Box { length: 2.0, width: 6.0, height: 2.0 }));
    }

    #[test]
    fn one_collider_holds_what_it_was_made_for() {
        for shape in [
            Shape::Sphere { radius: 0.3 },
            Shape::Cylinder { radius: 0.5, height: 0.2 },
            Shape::Box { length: 0.1, width: 0.7, height: 0.3 },
        ] {
            assert_eq!(body(&[Body::collider_of_shape(shape)]).shape(), Some(shape));
            assert!(math::hypot(shape.bounding_radius(), shape.height()) > 0.0);
        }
    }
}
