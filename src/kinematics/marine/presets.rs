use super::{CraftSpec, HullPart, Thruster};
use crate::geometry::{Point3, Vector3};

impl CraftSpec {
    /// Mako (book, section 8.1): two tubes in a frame, with a thruster at each side and each end.
    ///
    /// | value | origin |
    /// |---|---|
    /// | 1.34 m long, 0.645 m wide, 0.46 m high, 35 kg; two plastic tubes in an aluminium frame; four trolling motors of 12 V and 7 A | Braeunl et al. 2004 |
    /// | tubes of 160 and 110 mm | standard pipes, which carry 35 kg with a reserve of 2.8 %: "naturally buoyant" |
    /// | centre of mass 60 mm below the centre of volume | batteries in the lower tube |
    /// | thrusters 290 mm to each side, 500 mm ahead and behind, at the middle of the hull's height | inside the frame's outline, so that they turn without touching it: estimated |
    /// | lag of 0.2 s | a motor of 84 W with a propeller of 100 mm: estimated |
    /// | 25 N forward, 17.5 N backward | 84 W at 0.3 N/W, between trolling motors (0.37) and small thrusters (0.18); [`Thruster::BACK`] |
    /// | forward drag 42 N s²/m² | 0.084 m² of tubes, frame and motors, as a bluff body |
    /// | the rest | [`CraftSpec::of_hull`] |
    ///
    /// The origin is at the bottom, below the centre. Thrusters: 1 left, 2 front, 3 right, 4 back; 2 and 4
    /// lift when they turn forward.
    pub fn mako() -> Self {
        let tube = |radius, length, up| HullPart::Capsule {
            radius,
            length,
            axis: 0,
            centre: Point3::new(0.0, 0.0, up),
        };
        let hull = vec![tube(0.080, 1.34, 0.34), tube(0.055, 1.10, 0.055)];
        let mut craft = Self::of_hull(35.0, Point3::new(0.0, 0.0, 0.20), hull);
        craft.quadratic_damping[0] = 42.0;
        craft.linear_damping[0] = 4.2;
        let motor =
            |name: &str, x, y, direction| Thruster::new(name, Point3::new(x, y, 0.26), direction, 25.0);
        craft.thrusters = vec![
            motor("LEFT", 0.0, 0.29, Vector3::x()),
            motor("FRONT", 0.50, 0.0, Vector3::z()),
            motor("RIGHT", 0.0, -0.29, Vector3::x()),
            motor("BACK", -0.50, 0.0, Vector3::z()),
        ];
        craft
    }

    /// The solar raft (book, section 8.1): a 100 W solar panel on two watertight tubes, with two thrusters.
    ///
    /// The panel has the usual size for 100 W, 1.2 m by 0.54 m. Tubes of 160 mm by 1.3 m carry the total of
    /// 20 kg with two fifths of their volume. Thrusters of 30 N give about 1 m/s.
    pub fn solar_raft() -> Self {
        let tube = |left| HullPart::Capsule {
            radius: 0.08,
            length: 1.3,
            axis: 0,
            centre: Point3::new(0.0, left, 0.08),
        };
        let panel =
            HullPart::Box { size: Vector3::new(1.2, 0.54, 0.035), centre: Point3::new(0.0, 0.0, 0.22) };
        let mut raft = Self::of_hull(20.0, Point3::new(0.0, 0.0, 0.08), vec![tube(0.3), tube(-0.3), panel]);
        let motor =
            |name: &str, left| Thruster::new(name, Point3::new(-0.5, left, -0.03), Vector3::x(), 30.0);
        raft.thrusters = vec![motor("LEFT", 0.3), motor("RIGHT", -0.3)];
        raft
    }
}
