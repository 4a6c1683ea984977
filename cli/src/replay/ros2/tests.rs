use std::fs;
use std::io::Cursor;
use std::path::Path;

use proptest::prelude::*;
use roverlab::geometry::Pose as PlanarPose;
use roverlab::io::log::{Log, OpenLoop, Seen, Sight};
use roverlab::io::{Clock as _, Lidar, Odometry as _};
use roverlab::scan::{Localisation, LocalisationMap, Localiser, LocaliserParameters};
use roverlab::world::formats;
use serde::Serialize;

use super::bag::Bag;
use super::cdr::{decoded, encoded};
use super::messages::*;
use crate::tests::support::{said, temporary, text};

/// Bytes of some hexadecimal digits.
fn hex(digits: &str) -> Vec<u8> {
    let digits: Vec<u32> = digits.chars().filter_map(|digit| digit.to_digit(16)).collect();
    digits.chunks(2).map(|pair| (16 * pair[0] + pair[1]) as u8).collect()
}

/// Little-endian bytes as ROS 2 writes them: numbers are aligned behind the first four bytes, and texts end
/// in a zero.
#[test]
fn messages_have_the_bytes_of_ros() {
    let header = Header::new(3_000_000_007, "lidar");
    let scan = LaserScan { header, ranges: vec![1.5, f32::INFINITY], ..LaserScan::default() };
    let bytes = hex("00010000 03000000 07000000 06000000 6c6964617200 0000 \
         00000000 00000000 00000000 00000000 00000000 00000000 00000000 02000000 0000c03f 0000807f 00000000");
    assert_eq!(encoded(&scan), bytes);
    assert_eq!(decoded::<LaserScan>(&bytes), Ok(scan));
    let image = Image { data: Bytes(vec![1, 2, 3]), encoding: "rgb8".into(), ..Image::default() };
    assert_eq!(decoded::<Image>(&encoded(&image)), Ok(image.clone()));
    assert_eq!(encoded(&image)[4..].len() % 4, 3, "bytes without padding behind them");
    // Numbers of eight bytes are aligned to eight.
    let twist = TwistStamped { twist: Twist::default(), header: Header::new(0, "") };
    assert_eq!(encoded(&twist).len(), 4 + 8 + 4 + 1 + 7 - 4 + 48);
    // The other order of bytes is read as well.
    let big = hex("00000000 00000003 00000007");
    assert_eq!(decoded::<Time>(&big), Ok(Time { sec: 3, nanosec: 7 }));
}

#[test]
fn data_that_fit_no_message_are_refused() {
    let refused = |bytes: &[u8]| decoded::<LaserScan>(bytes).unwrap_err();
    assert_eq!(refused(&[0]), "found 1 bytes; expected CDR");
    assert!(refused(&[0, 7, 0, 0, 1]).contains("found data of the kind [00, 07]"));
    assert!(refused(&[0, 1, 0, 0, 1]).contains("do not fit their type"));
    // A text of four gigabytes, and a list of as many numbers, of which there is nothing.
    assert!(refused(&[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255]).contains("do not fit"));
    let mut scan = encoded(&LaserScan::default());
    let length = scan.len();
    scan[length - 8..length - 4].copy_from_slice(&[255; 4]);
    assert!(refused(&scan).contains("do not fit"));
}

/// A bag in memory.
fn bag(fill: impl FnOnce(&mut Bag<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut bag = Bag::new(Cursor::new(Vec::new())).unwrap();
    fill(&mut bag);
    bag.finish().unwrap().0.into_inner()
}

fn odometry(time: u64, pose: PlanarPose) -> Odometry {
    let header = Header::new(time, "odom");
    let pose = PoseWithCovariance { pose: Pose::of(&pose), ..PoseWithCovariance::default() };
    Odometry { header, child_frame_id: "base_link".into(), pose, ..Odometry::default() }
}

fn scan(frame: &str) -> LaserScan {
    LaserScan {
        header: Header::new(0, frame),
        angle_min: -1.0,
        angle_increment: 0.5,
        range_min: 0.1,
        range_max: 3.5,
        ranges: vec![1.0, 0.0, 9.0, f32::NAN, 2.0],
        ..LaserScan::default()
    }
}

fn placed(parent: &str, child: &str, rotation: [f64; 4]) -> TransformStamped {
    let [x, y, z, w] = rotation;
    let translation = Vector { x: 0.1, y: 0.0, z: 0.2 };
    TransformStamped {
        header: Header::new(0, parent),
        child_frame_id: child.into(),
        transform: Transform { translation, rotation: Quaternion { x, y, z, w } },
    }
}

/// Imports some bytes as a bag.
fn imported(name: &str, bytes: &[u8], more: &[&str]) -> Result<Log, String> {
    let [bag, out] = ["bag", "run"].map(|kind| temporary(&format!("ros2-{name}-{kind}.mcap")));
    fs::write(&bag, bytes).unwrap();
    let words = ["import", "--ros2", text(&bag), "--out", text(&out)];
    let (status, _, err) = said("replay", &[&words[..], more].concat());
    if status != 0 {
        assert_eq!((status, err.lines().count()), (2, 1), "{err}");
        return Err(err);
    }
    Ok(Log::read(fs::read(&out).unwrap()).unwrap())
}

/// What a recording shows of its robot, without the truth.
fn seen(log: &Log) -> Vec<Seen> {
    let all = log.messages().flat_map(|message| message.seen());
    all.filter(|seen| !matches!(seen.sight, Sight::Truth(_) | Sight::Distance(..) | Sight::Display(_)))
        .collect()
}

#[test]
fn scans_of_other_robots_become_ours() {
    let turned = [0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()];
    let bytes = bag(|bag| {
        let transforms =
            vec![placed("base_link", "post", [0.0, 0.0, 0.0, 1.0]), placed("post", "laser", turned)];
        bag.latch(5_000, "/tf_static", &TfMessage { transforms }).unwrap();
        bag.write(6_000, "/odom", &odometry(6_000, PlanarPose::new(1.0, 2.0, 3.0))).unwrap();
        bag.write(1_000_005_000, "/scan", &scan("laser")).unwrap();
        let clockwise = LaserScan { angle_min: 1.0, angle_increment: -0.5, ..scan("laser") };
        bag.write(1_000_004_000, "/scan", &clockwise).unwrap();
        bag.write(2_000_005_000, "/cmd_vel", &Twist::default()).unwrap();
    });
    let log = imported("others", &bytes, &[]).unwrap();
    let mut robot = OpenLoop::new(&log, 0).unwrap();
    robot.seek(1.0);
    let scan = robot.scan().unwrap();
    assert_eq!((scan.angle_min, scan.angle_increment, scan.range_max), (-1.0, 0.5, 3.5));
    let none = f64::INFINITY;
    assert_eq!(scan.ranges, [2.0, none, none, none, 1.0], "the later one, which goes clockwise");
    assert!(
        (scan.mount.x - 0.2).abs() < 1e-12 && (scan.mount.heading - 0.5 * std::f64::consts::PI).abs() < 1e-9
    );
    let times: Vec<f64> = seen(&log).iter().map(|seen| seen.time).collect();
    assert_eq!(times, [1e-6, 1.0, 1.0], "the late one is no earlier");
    assert!(log.entries(0).any(|entry| entry.method == "set_speed" && entry.time == 2.0));
}

/// A scanner that is not chosen is 0.3 m behind the robot, and another robot has odometry as well.
#[test]
fn the_mount_is_that_of_the_chosen_scanner() {
    let level = [0.0, 0.0, 0.0, 1.0];
    let bytes = bag(|bag| {
        let mut rear = placed("base_link", "rear", level);
        rear.transform.translation.x = -0.3;
        let transforms = vec![rear, placed("base_link", "front", level)];
        bag.latch(0, "/tf_static", &TfMessage { transforms }).unwrap();
        let other = Odometry { child_frame_id: "other".into(), ..odometry(0, PlanarPose::default()) };
        bag.write(0, "/other", &other).unwrap();
        bag.write(1_000_000_000, "/rear", &scan("rear")).unwrap();
        bag.write(1_000_000_000, "/scan", &scan("front")).unwrap();
        bag.write(2_000_000_000, "/odom", &odometry(2_000_000_000, PlanarPose::default())).unwrap();
    });
    let mount = |name: &str, more: &[&str]| {
        let log = imported(name, &bytes, more).unwrap();
        let mut robot = OpenLoop::new(&log, 0).unwrap();
        robot.seek(1.0);
        robot.scan().unwrap().mount.x
    };
    for (name, more, x) in [
        ("usual", &[][..], 0.1),
        ("rear", &["--scan", "/rear"], -0.3),
        ("unknown", &["--odometry", "/other"], 0.0),
    ] {
        assert!((mount(name, more) - x).abs() < 1e-12, "{name}: {}", mount(name, more));
    }
}

#[test]
fn depth_images_are_left_out() {
    let bytes = bag(|bag| {
        bag.write(0, "/scan", &scan("laser")).unwrap();
        bag.write(0, "/depth", &Image { encoding: "16UC1".into(), ..Image::default() }).unwrap();
    });
    let [bag, out] = ["bag", "run"].map(|kind| temporary(&format!("ros2-depth-{kind}.mcap")));
    fs::write(&bag, bytes).unwrap();
    let (status, said, err) = said("replay", &["import", "--ros2", text(&bag), "--out", text(&out)]);
    assert_eq!((status, said.contains("1 scans, 0 poses, 0 images")), (0, true), "{said}{err}");
    assert!(err.starts_with("/depth is left out: found the encoding \"16UC1\"; expected rgb8"), "{err}");
}

#[test]
fn bags_that_cannot_be_imported_are_refused() {
    let says = |name: &str, bytes: &[u8], more: &[&str]| imported(name, bytes, more).unwrap_err();
    let whole = bag(|bag| bag.write(0, "/scan", &scan("laser")).unwrap());
    let cases = [
        (says("empty", b"", &[]), "found no MCAP file"),
        (says("cut", &whole[..whole.len() - 40], &[]), "found the end of the file"),
        (
            says("none", &bag(|bag| bag.write(0, "/clock", &Clock::default()).unwrap()), &[]),
            "found rosgraph_msgs/msg/Clock; expected messages of sensor_msgs/msg/LaserScan or",
        ),
        (says("topic", &whole, &["--scan", "/front"]), "found no topic /front for --scan; expected /scan"),
        (
            says(
                "two",
                &bag(|bag| {
                    bag.write(0, "/front", &scan("a")).unwrap();
                    bag.write(0, "/rear", &scan("b")).unwrap();
                }),
                &[],
            ),
            "found /front, /rear; expected --scan with one of them",
        ),
        (
            says(
                "tilted",
                &bag(|bag| {
                    let transforms = vec![placed("base", "laser", [1.0, 0.0, 0.0, 0.0])];
                    bag.latch(0, "/tf_static", &TfMessage { transforms }).unwrap();
                    bag.write(0, "/scan", &scan("laser")).unwrap();
                }),
                &[],
            ),
            "found the frame \"laser\" tilted in \"base\"; expected a level one",
        ),
        (
            says(
                "nan",
                &bag(|bag| bag.write(0, "/odom", &odometry(0, PlanarPose::new(f64::NAN, 0.0, 0.0))).unwrap()),
                &[],
            ),
            "message 1 on /odom: found a pose that is none",
        ),
        (
            says(
                "image",
                &bag(|bag| {
                    bag.write(0, "/scan", &scan("laser")).unwrap();
                    let image =
                        Image { width: 9, height: 9, step: 9, encoding: "mono8".into(), ..Image::default() };
                    bag.write(0, "/image", &image).unwrap();
                }),
                &[],
            ),
            "message 1 on /image: found 0 bytes; expected 9 rows of 9 bytes",
        ),
        (
            says(
                "packed",
                &bag(|bag| {
                    bag.write(0, "/scan", &scan("laser")).unwrap();
                    bag.write(0, "/image", &Image { encoding: "bayer_rggb8".into(), ..Image::default() })
                        .unwrap();
                }),
                &["--camera", "/image"],
            ),
            "/image: found the encoding \"bayer_rggb8\"; expected rgb8",
        ),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected) && found.contains("-bag.mcap: "), "{found} has not: {expected}");
    }
    assert!(!temporary("ros2-image-run.mcap").exists(), "a recording that is not whole");
}

/// Anything in the place of a scan.
#[derive(Debug, Serialize)]
struct Odd(Vec<u8>);

impl Message for Odd {
    const NAME: &'static str = LaserScan::NAME;
}

proptest! {
    #![proptest_config(roverlab::testing::cases(64))]

    #[test]
    fn any_data_are_read_or_refused(data: Vec<u8>, at in 0_usize..2000, byte: u8) {
        let bytes = bag(|bag| bag.write(0, "/scan", &Odd(data.clone())).unwrap());
        let _ = imported("odd", &bytes, &[]);
        let mut bytes = bag(|bag| bag.write(0, "/scan", &scan("laser")).unwrap());
        let at = at % bytes.len();
        bytes[at] = byte;
        let _ = imported("odd", &bytes, &[]);
        let _ = (decoded::<TfMessage>(&data), decoded::<Image>(&data), decoded::<OccupancyGrid>(&data));
    }
}

/// Records a run of a command, exports it and imports it again.
fn there_and_back(name: &str, words: &[&str]) -> (Log, Log) {
    let [run, bag] = ["own", "exported"].map(|kind| temporary(&format!("ros2-{name}-{kind}.mcap")));
    let (status, _, err) = said(name, &[words, &["--json", "--record", text(&run)]].concat());
    assert!(status < 2, "{err}");
    let (status, out, err) = said("replay", &["export", text(&run), "--ros2", text(&bag), "--json"]);
    assert_eq!((status, err.as_str()), (0, ""), "{out}");
    let log = |file: &Path| fs::read(file).unwrap();
    (Log::read(log(&run)).unwrap(), imported(name, &log(&bag), &[]).unwrap())
}

#[test]
fn recordings_survive_as_bags() {
    for (name, words) in [
        ("distbug", &["--time-limit", "4"][..]),
        ("color-tracking", &["--time-limit", "2"]),
        ("first-steps", &["--seed", "3"]),
    ] {
        let (own, back) = there_and_back(name, words);
        let (before, after) = (seen(&own), seen(&back));
        assert_eq!(before.len(), after.len(), "{name}");
        assert!(before.len() > 10, "{name}: {} messages", before.len());
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(before.time, after.time);
            match (&before.sight, &after.sight) {
                (Sight::Scan(one), Sight::Scan(other)) => {
                    let same = |one: &f64, other: &f64| one == other || (one - other).abs() <= 1e-6 * one;
                    assert!(one.ranges.iter().zip(&other.ranges).all(|(one, other)| same(one, other)));
                    assert_eq!(one.ranges.len(), other.ranges.len());
                    assert!(
                        (one.mount.x - other.mount.x).abs() < 1e-9
                            && (one.angle_min - other.angle_min).abs() < 1e-6
                    );
                }
                (Sight::Odometry(one), Sight::Odometry(other)) => {
                    let apart = one.inverse().compose(other);
                    assert!(apart.x.abs() + apart.y.abs() + apart.heading.abs() < 1e-9, "{one:?} {other:?}");
                }
                (one, other) => assert_eq!(one, other),
            }
        }
        let commands = |log: &Log| {
            let entries = log.entries(0).filter(|entry| entry.method == "set_speed");
            entries.map(|entry| (entry.time.to_bits(), entry.arguments)).collect::<Vec<_>>()
        };
        assert_eq!(commands(&own), commands(&back), "{name}");
    }
}

/// Poses of a localiser that gets what a recording holds, where one place explains that.
fn localised(log: &Log, map: &LocalisationMap) -> Vec<Option<PlanarPose>> {
    let mut robot = OpenLoop::new(log, 0).unwrap();
    let mut localiser = Localiser::new(map.clone(), LocaliserParameters::default()).unwrap();
    let mut poses = Vec::new();
    while robot.wait(0.5).is_ok() {
        let (Ok(pose), Ok(scan)) = (robot.pose(), robot.scan()) else { break };
        localiser.update(pose, &scan).unwrap();
        poses.push(match localiser.localisation() {
            Localisation::One(place) => Some(place.pose),
            _ => None,
        });
    }
    poses
}

#[test]
fn a_robot_localises_itself_by_a_bag() {
    let (own, back) = there_and_back("localise", &["--seed", "4"]);
    let world = &own.header().attachment("scene.wld").unwrap().data;
    let world = formats::wld::parse(&String::from_utf8_lossy(world), "scene.wld").unwrap().value;
    let map = LocalisationMap::new(&world).unwrap();
    let (before, after) = (localised(&own, &map), localised(&back, &map));
    assert_eq!(before.len(), after.len());
    let apart: Vec<Option<f64>> = before
        .iter()
        .zip(&after)
        .map(|(one, other)| Some(one.as_ref()?.distance_to(other.as_ref()?.position())))
        .collect();
    let found = apart.iter().flatten().count();
    assert!(found > 5 && before.iter().flatten().count() == found, "{apart:?}");
    // Ranges have 32 bits in a bag: another one of equal places may come first, and more scans decide.
    let apart: Vec<f64> = apart.into_iter().flatten().collect();
    assert!(apart.iter().all(|apart| *apart < 0.02) && apart[found - 1] < 5e-4, "{apart:?}");
}
