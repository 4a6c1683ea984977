use nalgebra::{Quaternion, UnitQuaternion, Vector6};

use super::craft::{split, stack};
use super::{Craft, CraftMotion, CraftState, LocalWater, Thruster, Wrench};
use crate::geometry::{Point3, Vector3};

/// What changes in a step, and how fast.
#[derive(Debug, Clone, Copy)]
struct Flow {
    position: Vector3,
    attitude: Quaternion<f64>,
    speed: Vector6<f64>,
}

impl Craft {
    /// Integrates one step. Commands are fractions of each thruster's full speed, -1 to 1; missing ones count as 0.
    pub fn advance(&self, state: &mut CraftState, commands: &[f64], water: &LocalWater) {
        let wrench = self.thrust(state, commands, water);
        let by_itself = wrench == Vector6::zeros() && water.velocity == Vector3::zeros();
        if !(by_itself && self.is_at_surface(state, water)) {
            self.advance_by(state, water, |_| wrench);
            return;
        }
        let before = self.energy(state, water);
        self.advance_by(state, water, |_| wrench);
        self.give_back(state, self.energy(state, water) - before, water);
    }

    /// Takes energy from the motion to which a craft has come without a thruster, because an edge of its hull
    /// came to the surface within the step.
    fn give_back(&self, state: &mut CraftState, more: f64, water: &LocalWater) {
        let kinetic = self.kinetic(state, water);
        if more > 0.0 && kinetic > 0.0 {
            let left = (1.0 - more / kinetic).max(0.0).sqrt();
            state.velocity.linear *= left;
            state.velocity.angular *= left;
        }
    }

    /// Like [`advance`](Craft::advance), with additional forces that depend on the state.
    pub fn advance_under(
        &self,
        state: &mut CraftState,
        commands: &[f64],
        water: &LocalWater,
        forces: impl Fn(&CraftState) -> Wrench,
    ) {
        let thrust = self.thrust(state, commands, water);
        let shafts = state.shafts;
        self.advance_by(state, water, |at| {
            let (linear, angular) = split(&at.speed);
            let there = CraftState {
                position: Point3::from(at.position),
                attitude: UnitQuaternion::new_normalize(at.attitude),
                velocity: CraftMotion { linear, angular },
                shafts,
            };
            let wrench = forces(&there);
            thrust + stack(&wrench.force, &wrench.moment)
        });
    }

    #[inline]
    fn advance_by(&self, state: &mut CraftState, water: &LocalWater, forces: impl Fn(&Flow) -> Vector6<f64>) {
        let start = Flow {
            position: state.position.coords,
            attitude: state.attitude.into_inner(),
            speed: stack(&state.velocity.linear, &state.velocity.angular),
        };
        let half = 0.5 * self.step;
        let first = self.flow(&start, &forces, water);
        let second = self.flow(&start.moved(&first, half), &forces, water);
        let third = self.flow(&start.moved(&second, half), &forces, water);
        let fourth = self.flow(&start.moved(&third, self.step), &forces, water);
        let mean = Flow {
            position: (first.position + 2.0 * (second.position + third.position) + fourth.position) / 6.0,
            attitude: (first.attitude + (second.attitude + third.attitude) * 2.0 + fourth.attitude) / 6.0,
            speed: (first.speed + 2.0 * (second.speed + third.speed) + fourth.speed) / 6.0,
        };
        let end = start.moved(&mean, self.step);
        state.position = Point3::from(end.position);
        state.attitude = UnitQuaternion::new_normalize(end.attitude);
        let (linear, angular) = split(&end.speed);
        state.velocity = CraftMotion { linear, angular };
    }

    /// Lets the thrusters follow their commands for a step, and returns their force in the middle of it.
    fn thrust(&self, state: &mut CraftState, commands: &[f64], water: &LocalWater) -> Vector6<f64> {
        let mut sum = Vector6::zeros();
        for (number, thruster) in self.thrusters.iter().enumerate() {
            let command = commands.get(number).map_or(0.0, |command| command.clamp(-1.0, 1.0));
            let decay = self.decays[number];
            let shaft = command + (state.shafts[number] - command) * decay;
            state.shafts[number] = command + (shaft - command) * decay;
            if shaft == 0.0 {
                continue;
            }
            let full = if shaft > 0.0 { thruster.force } else { thruster.back };
            let depth = water.level - (state.position + state.attitude * thruster.place.coords).z;
            let grip = (0.5 * (1.0 + depth / Thruster::RADIUS)).clamp(0.0, 1.0);
            let force = thruster.direction * (full * shaft * shaft.abs() * grip);
            sum += stack(&force, &thruster.place.coords.cross(&force));
        }
        sum
    }

    #[inline]
    fn flow(&self, at: &Flow, forces: &impl Fn(&Flow) -> Vector6<f64>, water: &LocalWater) -> Flow {
        let attitude = UnitQuaternion::new_normalize(at.attitude);
        let rotation = attitude.to_rotation_matrix();
        let (linear, angular) = split(&at.speed);
        let position = Point3::from(at.position);
        Flow {
            position: rotation * linear,
            attitude: at.attitude * Quaternion::from_parts(0.0, 0.5 * angular),
            speed: self.rates(&position, &rotation, &at.speed, &forces(at), water),
        }
    }
}

impl Flow {
    #[inline]
    fn moved(&self, rates: &Flow, seconds: f64) -> Flow {
        Flow {
            position: self.position + rates.position * seconds,
            attitude: self.attitude + rates.attitude * seconds,
            speed: self.speed + rates.speed * seconds,
        }
    }
}
