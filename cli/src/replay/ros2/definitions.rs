//! The public definitions of messages, as a bag holds them: without comments, with all that they are made of.

/// Definitions by type. Types in them are in full.
const DEFINITIONS: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    (
        "nav_msgs/MapMetaData",
        "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n\
         geometry_msgs/Pose origin\n",
    ),
    ("nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"),
    (
        "sensor_msgs/LaserScan",
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
         float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
         float32[] ranges\nfloat32[] intensities\n",
    ),
    (
        "sensor_msgs/Image",
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n\
         uint32 step\nuint8[] data\n",
    ),
    ("rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n"),
];

/// The definition of a message and of all types in it; `name` has `/msg/` in its middle.
pub(super) fn definition(name: &str) -> String {
    let mut needed = vec![name.replace("/msg/", "/")];
    let mut text = String::new();
    let mut next = 0;
    while let Some(name) = needed.get(next).cloned() {
        // All names in this file are in the table, as a test verifies.
        let own = DEFINITIONS.iter().find(|(other, _)| *other == name).map_or("", |(_, own)| own);
        if next > 0 {
            text += &["=".repeat(80).as_str(), "\nMSG: ", &name, "\n"].concat();
        }
        text += own;
        for kind in own.lines().filter_map(|line| line.split([' ', '[']).next()) {
            if kind.contains('/') && !needed.iter().any(|other| other == kind) {
                needed.push(kind.to_owned());
            }
        }
        next += 1;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_types_are_defined() {
        for (name, own) in DEFINITIONS {
            for kind in own.lines().map(|line| line.split([' ', '[']).next().unwrap()) {
                let known = !kind.contains('/') || DEFINITIONS.iter().any(|(other, _)| *other == kind);
                assert!(known, "{name}: {kind}");
            }
        }
        let clock = definition("rosgraph_msgs/msg/Clock");
        let parts = clock.split(&format!("{}\n", "=".repeat(80))).collect::<Vec<_>>();
        let time = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
        assert_eq!(parts, ["builtin_interfaces/Time clock\n", time]);
        assert!(definition("nav_msgs/msg/Odometry").contains("MSG: geometry_msgs/Vector3\n"));
    }
}
