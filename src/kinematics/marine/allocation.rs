use nalgebra::{Matrix6, SMatrix, Vector6};

use super::craft::stack;
use super::{Craft, MAX_THRUSTERS, Thruster, Wrench};

/// Control allocation: distributes a desired force and moment among a craft's thrusters.
///
/// The forces of the thrusters are the least-squares solution. If one exceeds its limit, all are scaled down by
/// the same factor, which keeps the direction of force and moment (Fossen 2021, section 11.2).
///
/// ```
/// use roverlab::geometry::Vector3;
/// use roverlab::kinematics::marine::{Allocation, Craft, CraftSpec, Wrench};
///
/// let mako = Craft::new(&CraftSpec::mako(), 0.01)?;
/// let ahead = Wrench { force: Vector3::x() * 25.0, moment: Vector3::zeros() };
/// let shared = Allocation::new(&mako).share(&ahead);
/// assert!((shared.commands[0] - 0.5_f64.sqrt()).abs() < 1e-6 && shared.commands[1].abs() < 0.01);
/// assert_eq!(shared.share, 1.0);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Allocation {
    /// From a force and a moment to the thrusters' forces.
    shares: SMatrix<f64, MAX_THRUSTERS, 6>,
    limits: Vec<(f64, f64)>,
}

/// Commands to the thrusters, and how much of the desired force they achieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allocated {
    /// Fraction of each thruster's full speed, -1 to 1.
    pub commands: [f64; MAX_THRUSTERS],
    /// Fraction of the desired force and moment that is achieved, in the directions that the thrusters can act
    /// in; 1 unless a thruster is at its limit.
    pub share: f64,
}

/// What keeps directions in which no thruster pushes out of the least squares, beside forces of N² and
/// moments of N² m².
const LITTLE: f64 = 1e-9;

impl Allocation {
    /// Creates the allocation for a craft's thrusters.
    pub fn new(craft: &Craft) -> Self {
        let thrusters = craft.thrusters();
        let mut pushes = SMatrix::<f64, 6, MAX_THRUSTERS>::zeros();
        for (number, Thruster { place, direction, force, .. }) in thrusters.iter().enumerate() {
            if *force > 0.0 {
                pushes.set_column(number, &stack(direction, &place.coords.cross(direction)));
            }
        }
        let square = pushes * pushes.transpose() + Matrix6::identity() * LITTLE;
        let inverse = square.try_inverse().unwrap_or_else(Matrix6::zeros);
        let limits = thrusters.iter().map(|thruster| (thruster.force, thruster.back)).collect();
        Self { shares: pushes.transpose() * inverse, limits }
    }

    /// The commands for a force and a moment about the centre of the craft's hull.
    pub fn share(&self, wish: &Wrench) -> Allocated {
        let wish: Vector6<f64> = stack(&wish.force, &wish.moment);
        let forces = self.shares * wish;
        let strength = |number: usize, force: f64| {
            let (forward, back) = self.limits[number];
            if force >= 0.0 { forward } else { back }
        };
        let strain = |number: usize| {
            let most = strength(number, forces[number]);
            // A thruster that cannot push that way at all does not hold the others back.
            if most > 0.0 { forces[number].abs() / most } else { 0.0 }
        };
        let most = (0..self.limits.len()).map(strain).fold(1.0, f64::max);
        let mut commands = [0.0; MAX_THRUSTERS];
        for (number, command) in commands.iter_mut().enumerate().take(self.limits.len()) {
            let force = forces[number] / most;
            let strength = strength(number, force);
            if strength > 0.0 {
                *command = (force.abs() / strength).sqrt().min(1.0).copysign(force);
            }
        }
        Allocated { commands, share: 1.0 / most }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CraftSpec, CraftState, LocalWater};
    use super::*;
    use crate::geometry::{Point3, Pose3, Vector3};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn commands_make_the_wish_or_its_share(
            ahead in -90.0..90.0f64, up in -90.0..90.0f64, pitch in -20.0..20.0f64, yaw in -20.0..20.0f64,
        ) {
            let craft = Craft::new(&CraftSpec::mako(), 0.01).unwrap();
            let wish = Wrench { force: Vector3::new(ahead, 0.0, up), moment: Vector3::new(0.0, pitch, yaw) };
            let Allocated { commands, share } = Allocation::new(&craft).share(&wish);
            prop_assert!(share > 0.0 && share <= 1.0 && commands.iter().all(|command| command.abs() <= 1.0));
            prop_assert!(share == 1.0 || commands.iter().any(|command| command.abs() > 1.0 - 1e-9));
            // A step with shafts at their commands moves as the wish's share does.
            let mut state = CraftState::at_rest(&craft, &Pose3::from_angles(Point3::new(0.0, 0.0, -9.0), 0.0, 0.0, 0.0));
            let mut wished = state;
            state.shafts = commands;
            craft.advance(&mut state, &commands, &LocalWater::still(0.0));
            let part = Wrench { force: wish.force * share, moment: wish.moment * share };
            craft.advance_under(&mut wished, &[], &LocalWater::still(0.0), |_| part);
            prop_assert!((state.velocity.linear - wished.velocity.linear).norm() < 1e-6);
            prop_assert!((state.velocity.angular - wished.velocity.angular).norm() < 1e-6);
        }
    }

    #[test]
    fn what_no_thruster_can_do_costs_nothing() {
        let craft = Craft::new(&CraftSpec::mako(), 0.01).unwrap();
        let aside = Wrench { force: Vector3::y() * 50.0, moment: Vector3::x() * 9.0 };
        let shared = Allocation::new(&craft).share(&aside);
        assert!(shared.commands.iter().all(|command| command.abs() < 1e-3), "{shared:?}");
        let none = Craft::new(&CraftSpec { thrusters: Vec::new(), ..CraftSpec::mako() }, 0.01).unwrap();
        assert_eq!(Allocation::new(&none).share(&aside).share, 1.0);
    }
}
