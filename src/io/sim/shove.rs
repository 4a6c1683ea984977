use crate::geometry::Vector3;

/// Change of a velocity by an obstacle that moves a body aside at a speed in a tick: as much of that speed as
/// led into the obstacle. A body that was placed in one is moved out of it, not thrown.
pub(super) fn stopping(velocity: &Vector3, aside: &Vector3) -> Vector3 {
    let square = aside.norm_squared();
    let share = if square > 0.0 { (-velocity.dot(aside) / square).clamp(0.0, 1.0) } else { 0.0 };
    aside * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_speed_into_the_obstacle_is_lost() {
        let velocity = Vector3::new(-0.3, 0.2, 0.0);
        for (aside, left) in [(0.1, -0.2), (0.3, 0.0), (14.0, 0.0), (-14.0, -0.3), (0.0, -0.3)] {
            let found = velocity + stopping(&velocity, &Vector3::new(aside, 0.0, 0.0));
            assert!((found - Vector3::new(left, 0.2, 0.0)).norm() < 1e-12, "{aside}: {found:?}");
        }
    }
}
