use std::path::PathBuf;
use std::sync::Arc;

use image::RgbaImage;

use super::{Body, Colour, Mesh};
use crate::geometry::{Point, Pose};

/// An upright solid on the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A cylinder, or an upright capsule.
    Cylinder {
        /// Distance from the axis to the surface (m).
        radius: f64,
        /// Height from foot to top (m).
        height: f64,
    },
    /// A truncated cone.
    Cone {
        /// Radius of its foot (m).
        radius: f64,
        /// Radius of its top (m).
        top: f64,
        /// Height from foot to top (m).
        height: f64,
    },
    /// A ball.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// A cuboid.
    Box {
        /// Length along the object's x axis (m).
        length: f64,
        /// Width along the object's y axis (m).
        width: f64,
        /// Height from foot to top (m).
        height: f64,
    },
}

impl Shape {
    /// Height from foot to top (m).
    pub fn height(&self) -> f64 {
        match *self {
            Shape::Cylinder { height, .. } | Shape::Cone { height, .. } | Shape::Box { height, .. } => height,
            Shape::Sphere { radius } => 2.0 * radius,
        }
    }

    /// Radius of the smallest enclosing circle about the object's axis (m).
    pub fn bounding_radius(&self) -> f64 {
        match *self {
            Shape::Cylinder { radius, .. } | Shape::Sphere { radius } => radius,
            Shape::Cone { radius, top, .. } => radius.max(top),
            Shape::Box { length, width, .. } => 0.5 * crate::geometry::math::hypot(length, width),
        }
    }
}

/// Common properties of all objects of a kind: EyeSim's `.esObj`, or a predefined object.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::world::{Colour, Object, ObjectKind, Shape, World};
/// let ball = ObjectKind::new("ball", Shape::Sphere { radius: 0.1 }, Colour::RED);
/// let mut world = World::empty(2.0, 2.0);
/// world.objects.push(Object::new(ball.into(), Pose::new(1.0, 1.0, 0.0)));
/// assert_eq!(world.objects[0].kind.shape.height(), 0.2);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectKind {
    /// Name for scenes.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
    /// Its colour.
    pub colour: Colour,
    /// Mass (kg).
    pub mass: f64,
    /// Whether it stays in place when pushed.
    pub fixed: bool,
    /// Whether it falls over when touched by a robot that weighs at least as much. It then lies flat: nothing
    /// collides with it and no sensor sees it.
    pub falls: bool,
    /// Displaced volume of water, for floating things (m³).
    pub buoyancy: Option<f64>,
    /// File of its 3D model.
    pub model: Option<PathBuf>,
    /// Surface for cameras; default: the shape.
    pub mesh: Option<Arc<Mesh>>,
    /// Data of its description file about its solid beyond the shape.
    pub body: Body,
}

impl ObjectKind {
    /// A kind with a name, shape and colour; 1 kg, movable.
    pub fn new(name: impl Into<String>, shape: Shape, colour: Colour) -> Self {
        Self {
            name: name.into(),
            shape,
            colour,
            mass: 1.0,
            fixed: false,
            falls: false,
            buoyancy: None,
            model: None,
            mesh: None,
            body: Body::default(),
        }
    }
}

/// An object in a world.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its kind.
    pub kind: Arc<ObjectKind>,
    /// Position of its axis, and its orientation.
    pub pose: Pose,
    /// Height of its foot above the floor (m).
    pub elevation: f64,
}

impl Object {
    /// An object on the floor.
    pub fn new(kind: Arc<ObjectKind>, pose: Pose) -> Self {
        Self { kind, pose, elevation: 0.0 }
    }
}

/// A picture on an upright board of zero thickness: a sign, a figure, a poster.
///
/// Only cameras see it; robots and other sensors do not notice it.
#[derive(Debug, Clone, PartialEq)]
pub struct Billboard {
    /// Middle of its lower edge; its picture faces along the heading, and its back is gray.
    pub pose: Pose,
    /// Width (m).
    pub width: f64,
    /// Height (m).
    pub height: f64,
    /// Height of its lower edge above the floor (m).
    pub elevation: f64,
    /// The picture; pixels with less than half opacity are invisible.
    pub image: Arc<RgbaImage>,
}

/// A coloured mark on the floor, without physical effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marker {
    /// Its centre.
    pub position: Point,
    /// Its colour.
    pub colour: Colour,
    /// Opacity, 0 to 255.
    pub alpha: u8,
}
