use std::path::PathBuf;
use std::sync::Arc;

use image::RgbaImage;

use super::{Body, Colour, Mesh};
use crate::geometry::{Point, Pose};

/// A solid that stands on the floor, upright.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A cylinder, or an upright capsule.
    Cylinder {
        /// Metres from the axis to the surface.
        radius: f64,
        /// Metres from foot to top.
        height: f64,
    },
    /// A blunt cone.
    Cone {
        /// Metres from the axis to the edge of its foot.
        radius: f64,
        /// Metres from the axis to the edge of its top.
        top: f64,
        /// Metres from foot to top.
        height: f64,
    },
    /// A ball.
    Sphere {
        /// Metres.
        radius: f64,
    },
    /// A cuboid.
    Box {
        /// Metres along the object's x axis.
        length: f64,
        /// Metres along the object's y axis.
        width: f64,
        /// Metres from foot to top.
        height: f64,
    },
}

impl Shape {
    /// Metres from the foot to the top.
    pub fn height(&self) -> f64 {
        match *self {
            Shape::Cylinder { height, .. } | Shape::Cone { height, .. } | Shape::Box { height, .. } => height,
            Shape::Sphere { radius } => 2.0 * radius,
        }
    }

    /// The radius of the circle around the object's axis that just holds it.
    pub fn bounding_radius(&self) -> f64 {
        match *self {
            Shape::Cylinder { radius, .. } | Shape::Sphere { radius } => radius,
            Shape::Cone { radius, top, .. } => radius.max(top),
            Shape::Box { length, width, .. } => 0.5 * crate::geometry::math::hypot(length, width),
        }
    }
}

/// What all objects of one kind share: EyeSim's `.esObj`, or one of its predefined objects.
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
    /// The name under which scenes place it.
    pub name: String,
    /// Its outline.
    pub shape: Shape,
    /// Its colour.
    pub colour: Colour,
    /// Kilograms.
    pub mass: f64,
    /// Whether it stays where it is when something pushes it.
    pub fixed: bool,
    /// Whether it falls over when a robot that weighs no less than it does touches it. It lies flat then:
    /// nothing meets it and no sensor sees it.
    pub falls: bool,
    /// Cubic metres of water that it displaces, for things that float.
    pub buoyancy: Option<f64>,
    /// The file of its 3D model, if it has one.
    pub model: Option<PathBuf>,
    /// The surface that cameras see; without it, they see the shape.
    pub mesh: Option<Arc<Mesh>>,
    /// What its description file says about its solid beyond the shape.
    pub body: Body,
}

impl ObjectKind {
    /// A kind with a name, a shape and a colour, of 1 kg, movable.
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
    /// What it is.
    pub kind: Arc<ObjectKind>,
    /// Where its axis stands, and how it is turned.
    pub pose: Pose,
    /// Metres between the floor and its foot.
    pub elevation: f64,
}

impl Object {
    /// An object on the floor.
    pub fn new(kind: Arc<ObjectKind>, pose: Pose) -> Self {
        Self { kind, pose, elevation: 0.0 }
    }
}

/// A picture on an upright board of no thickness: a sign, a figure, a poster.
///
/// Cameras see it; no robot touches it and no other sensor notices it.
#[derive(Debug, Clone, PartialEq)]
pub struct Billboard {
    /// The middle of its lower edge; its picture faces the way of the heading, and its back is gray.
    pub pose: Pose,
    /// Metres from its left to its right edge.
    pub width: f64,
    /// Metres from its lower to its upper edge.
    pub height: f64,
    /// Metres from the floor to its lower edge.
    pub elevation: f64,
    /// The picture; pixels less than half opaque are not there.
    pub image: Arc<RgbaImage>,
}

/// A coloured mark on the floor, which no robot touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marker {
    /// Its middle.
    pub position: Point,
    /// Its colour.
    pub colour: Colour,
    /// Opacity, 0 to 255.
    pub alpha: u8,
}
