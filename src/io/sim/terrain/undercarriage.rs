use std::f64::consts::FRAC_PI_4;

pub(in crate::io::sim) use crate::geometry::units::GRAVITY;
use crate::geometry::{Vector, Vector3, direction, math, units};
use crate::kinematics::{PlanarTwist, Tracked};
use crate::world::{DriveSpec, Footprint, RobotSpec};

/// Parts of a robot that can touch the ground, and their friction.
#[derive(Debug, Clone)]
pub(super) struct Undercarriage {
    /// Centre of mass in the robot's frame, whose origin is on the ground under the driven axle.
    pub(super) centre: Vector3,
    /// Square of the mean radius of gyration (m²).
    pub(super) gyration: f64,
    pub(super) feet: Vec<Foot>,
    /// Sinking of a foot per acceleration of the body (s²).
    pub(super) softness: f64,
    /// Coefficient of friction.
    pub(super) friction: f64,
}

/// A point that may touch the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    /// Position relative to the centre of mass.
    pub(super) place: Vector3,
    pub(super) grip: Grip,
}

/// Directions of a foot's friction.
#[derive(Debug, Clone, Copy)]
pub(super) enum Grip {
    /// A part of a driven wheel or belt, which moves forwards with its axle and not sideways; with the axle's
    /// position from the robot's origin.
    Driven(Vector),
    /// A wheel that rolls freely along its axle's motion, and does not slide sideways.
    Rolling(Vector),
    /// A Mecanum wheel, which is held only along its roller's axis: the wheel's position and that axis.
    Roller(Vector, Vector),
    /// The body itself.
    Body,
    /// A castor, which rolls in any direction.
    Free,
}

/// Sinking of a body on all its wheels (m).
const SAG: f64 = 1e-4;
/// Angles from straight down of the points of a wheel that may touch the ground (degrees).
const RIM: [f64; 5] = [-60.0, -30.0, 0.0, 30.0, 60.0];
/// Position of the centre of mass between axle and castor, as a fraction.
const BETWEEN: f64 = 0.3;
/// Height of the centre of mass, as a fraction of the robot's.
const MIDDLE: f64 = 0.4;

impl Undercarriage {
    /// The undercarriage from a robot's description.
    ///
    /// A two-wheeled drive also stands on a castor at the farther end of the outline. Defaults replace
    /// missing data: the centre of mass is at two fifths of the height, near the driven axle or between the
    /// axles.
    pub(super) fn of(spec: &RobotSpec) -> Self {
        let (back, front) = ends(&spec.footprint);
        let mut feet = Vec::new();
        let (wheels, ahead) = match spec.drive {
            DriveSpec::Differential { wheel_diameter, track, .. } => {
                let castor = if front > -back { front } else { back };
                for side in [0.5, -0.5] {
                    let axle = Vector::new(0.0, side * track);
                    wheel(&mut feet, axle, 0.5 * wheel_diameter, Grip::Driven(axle));
                }
                feet.push(Foot { place: Vector3::new(castor, 0.0, 0.0), grip: Grip::Free });
                (3, BETWEEN * castor)
            }
            DriveSpec::Tracked { wheel_diameter, track, length, width, .. } => {
                belts(&mut feet, Tracked { track, length, width }, 0.5 * wheel_diameter);
                (4, 0.0)
            }
            DriveSpec::Ackermann { wheel_diameter, track, wheelbase, .. } => {
                for side in [0.5, -0.5] {
                    let (rear, steered) =
                        (Vector::new(0.0, side * track), Vector::new(wheelbase, side * track));
                    wheel(&mut feet, rear, 0.5 * wheel_diameter, Grip::Driven(rear));
                    wheel(&mut feet, steered, 0.5 * wheel_diameter, Grip::Rolling(steered));
                }
                (4, 0.5 * wheelbase)
            }
            DriveSpec::Omni { wheel_diameter, track, wheelbase, .. } => {
                for (ahead, side) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                    let place = Vector::new(ahead * wheelbase, side * track);
                    let roller = Vector::new(1.0, -(ahead * side).signum()).normalize();
                    wheel(&mut feet, place, 0.5 * wheel_diameter, Grip::Roller(place, roller));
                }
                (4, 0.0)
            }
            DriveSpec::Craft(_) => (0, 0.0),
        };
        feet.extend(chassis(spec, ahead));
        let centre = stated_centre(spec).unwrap_or(Vector3::new(ahead, 0.0, MIDDLE * spec.height));
        Self::new(feet, centre, gyration(spec), wheels, spec.friction)
    }

    /// An undercarriage of feet at positions relative to the robot's origin.
    pub(super) fn new(
        mut feet: Vec<Foot>,
        centre: Vector3,
        gyration: f64,
        wheels: u32,
        friction: f64,
    ) -> Self {
        for foot in &mut feet {
            foot.place -= centre;
        }
        Self { centre, gyration, feet, softness: f64::from(wheels) * SAG / GRAVITY, friction }
    }
}

impl Grip {
    /// Forward and lateral speed of the rim or belt for a speed commanded to the drive.
    #[inline]
    pub(super) fn rim_speed(&self, drive: &PlanarTwist) -> Vector {
        match self {
            Self::Driven(axle) | Self::Rolling(axle) | Self::Roller(axle, _) => {
                Vector::new(drive.forward - drive.angular * axle.y, drive.left + drive.angular * axle.x)
            }
            Self::Body | Self::Free => Vector::zeros(),
        }
    }
}

/// Points of a wheel's rim that may touch the ground.
fn wheel(feet: &mut Vec<Foot>, axle: Vector, radius: f64, grip: Grip) {
    feet.extend(RIM.map(|degrees| {
        let (sin, cos) = math::sin_cos(units::from_deg(degrees));
        Foot { place: Vector3::new(axle.x + radius * sin, axle.y, radius * (1.0 - cos)), grip }
    }));
}

/// Points of belts that may touch the ground: below, and on the rise towards the wheels at their ends.
fn belts(feet: &mut Vec<Foot>, drive: Tracked, radius: f64) {
    let half = 0.5 * drive.equivalent().track;
    for side in [1.0, -1.0] {
        // A belt's speed is that of the equivalent drive's wheel.
        let grip = Grip::Driven(Vector::new(0.0, side * half));
        let below = drive.places(side).map(|place| Vector3::new(place.x, place.y, 0.0));
        feet.extend(below.map(|place| Foot { place, grip }));
        for end in [0.5, -0.5] {
            for degrees in [30.0, 60.0, 90.0] {
                let (sin, cos) = math::sin_cos(units::from_deg(degrees));
                let x = end * drive.length + end.signum() * radius * sin;
                let place = Vector3::new(x, side * 0.5 * drive.track, radius * (1.0 - cos));
                feet.push(Foot { place, grip });
            }
        }
    }
}

/// Centre of mass stated in a description, relative to the origin of the robot's model.
fn stated_centre(spec: &RobotSpec) -> Option<Vector3> {
    let ([x, y, z], [ahead, up]) = (spec.body.mass_centre.map(|c| c * spec.body.scale), spec.body.axle);
    let centre = Vector3::new(x - ahead, y, z - up + 0.5 * wheel_diameter(spec));
    (spec.body.mass_centre != [0.0; 3] && centre.z > 0.0).then_some(centre)
}

/// Ends of the outline along x.
fn ends(footprint: &Footprint) -> (f64, f64) {
    match footprint {
        Footprint::Disc { radius } => (-radius, *radius),
        Footprint::Rectangle(rectangle) => (rectangle.min.x, rectangle.max.x),
    }
}

/// Corners of the outline, at its top and at the axle's height, and the belly at half that height.
fn chassis(spec: &RobotSpec, belly: f64) -> Vec<Foot> {
    let axle = (0.5 * wheel_diameter(spec)).min(0.5 * spec.height);
    let outline: Vec<Vector> = match spec.footprint {
        Footprint::Disc { radius } => {
            (0..8).map(|eighth| direction(FRAC_PI_4 * f64::from(eighth)) * radius).collect()
        }
        Footprint::Rectangle(b) => [b.min.x, b.max.x]
            .into_iter()
            .flat_map(|x| [b.min.y, b.max.y].map(|y| Vector::new(x, y)))
            .collect(),
    };
    let corners = [axle, spec.height]
        .into_iter()
        .flat_map(|height| outline.iter().map(move |corner| Vector3::new(corner.x, corner.y, height)));
    let belly = [Vector3::new(belly, 0.0, 0.5 * axle)];
    corners.chain(belly).map(|place| Foot { place, grip: Grip::Body }).collect()
}

fn wheel_diameter(spec: &RobotSpec) -> f64 {
    match spec.drive {
        DriveSpec::Differential { wheel_diameter, .. }
        | DriveSpec::Ackermann { wheel_diameter, .. }
        | DriveSpec::Tracked { wheel_diameter, .. }
        | DriveSpec::Omni { wheel_diameter, .. } => wheel_diameter,
        DriveSpec::Craft(_) => 0.0,
    }
}

/// Square of the mean radius of gyration of a block of the robot's size.
fn gyration(spec: &RobotSpec) -> f64 {
    let size = match spec.footprint {
        Footprint::Disc { radius } => Vector::new(1.7 * radius, 1.7 * radius),
        Footprint::Rectangle(rectangle) => rectangle.size(),
    };
    (2.0 / 36.0) * (size.norm_squared() + spec.height * spec.height)
}
