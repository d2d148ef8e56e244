//! What descriptions mean: xacro, kinematics, meshes, SRDF, maps, each on a small example.

mod common;

use std::f64::consts::FRAC_PI_2;

use common::{FilesInMemory, read, told};
use hrdsl_robots::{
    MapMode, MeshAxis, MeshChoice, PackageTable, RobotReading, RobotRequest, UrdfGeometry, UrdfRobot,
    expanded_text, read_map, read_mesh, read_robot,
};
use hrdsl_source::{SourceFiles, Span};
use proptest::{collection::vec, prelude::*};

fn sound(files: &SourceFiles, reading: RobotReading) -> UrdfRobot {
    assert!(reading.faults.is_empty(), "{:#?}", told(files, &reading));
    reading.robot.unwrap()
}

/// What is in `<robot>` after xacro, without blanks between elements.
fn expanded(inside: &str, others: &[(&str, &str)]) -> String {
    let text = format!("<robot name='r'>{inside}</robot>");
    let reader = FilesInMemory::default().with("w/r.xacro", text);
    let reader = others.iter().fold(reader, |reader, (path, text)| reader.with(path, *text));
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let packages = PackageTable::new().with("pkg", "p");
    let arguments = [("given".to_owned(), "7".to_owned())];
    let environment = [("SIDE".to_owned(), "left".to_owned())];
    let request = RobotRequest {
        arguments: &arguments,
        environment: &environment,
        ..RobotRequest::new("w/r.xacro", place, &packages)
    };
    match expanded_text(&request, &mut files, &reader) {
        Ok(text) => {
            let inside = text.strip_prefix("<robot name=\"r\">").and_then(|t| t.strip_suffix("</robot>"));
            inside.unwrap_or_default().split('\n').map(str::trim).collect::<String>()
        }
        Err(faults) => format!("{}: {}", faults[0].kind.word(), faults[0].kind),
    }
}

/// What stands in `<robot>`, and what it comes to.
const EXPANSIONS: &[(&str, &str)] = &[
    // Properties are evaluated when they are first asked for.
    (
        "<xacro:property name='a' value='${b * 2}'/><xacro:property name='b' value='3'/><x v='${a}'/>",
        "<x v=\"6\"/>",
    ),
    (
        "<xacro:property name='a' value='1'/><xacro:property name='b' value='${a}' lazy_eval='false'/><xacro:property name='a' value='2'/><x v='${b}'/>",
        "<x v=\"1\"/>",
    ),
    (
        "<xacro:property name='a' default='1'/><xacro:property name='a' default='2'/><x v='${a}'/>",
        "<x v=\"1\"/>",
    ),
    (
        "<xacro:property name='a' value='1'/><xacro:property name='a' remove='true'/><xacro:property name='a' default='2'/><x v='${a}'/>",
        "<x v=\"2\"/>",
    ),
    ("<xacro:property name='n' value='0.10'/><x v='${n} m' w='$${n}'/>", "<x v=\"0.1 m\" w=\"${n}\"/>"),
    // Scopes.
    (
        "<xacro:macro name='m'><xacro:property name='a' value='2'/><xacro:property name='p' value='3' scope='parent'/><xacro:property name='g' value='4' scope='global'/></xacro:macro><xacro:property name='a' value='1'/><xacro:m/><x v='${a}${p}${g}'/>",
        "<x v=\"134\"/>",
    ),
    // Macros, with defaults, forwarded properties and blocks.
    (
        "<xacro:macro name='m' params='a b:=2 c:=^|3 *o **i'><x v='${a}${b}${c}'><xacro:insert_block name='o'/><xacro:insert_block name='i'/></x></xacro:macro><xacro:property name='c' value='9'/><xacro:m a='1'><o v='${c}'/><i><j/><k/></i></xacro:m>",
        "<x v=\"129\"><o v=\"9\"/><j/><k/></x>",
    ),
    (
        "<xacro:property name='block'><a v='${n}'/><b/></xacro:property><xacro:property name='n' value='5'/><xacro:insert_block name='block'/>",
        "<a v=\"5\"/><b/>",
    ),
    (
        "<xacro:macro name='count' params='n'><xacro:if value='${n > 0}'><x v='${n}'/><xacro:count n='${n - 1}'/></xacro:if></xacro:macro><xacro:count n='3'/>",
        "<x v=\"3\"/><x v=\"2\"/><x v=\"1\"/>",
    ),
    (
        "<xacro:macro name='m'><x/></xacro:macro><xacro:property name='which' value='m'/><xacro:call macro='${which}'/>",
        "<x/>",
    ),
    // Conditions.
    (
        "<xacro:if value='true'><a/></xacro:if><xacro:unless value='1'><b/></xacro:unless><xacro:if value='${1 == 2 or not 3 &lt; 2}'><c/></xacro:if>",
        "<a/><c/>",
    ),
    // Elements and attributes by name.
    (
        "<x><xacro:attribute name='v' value='${1 + 1}'/></x><xacro:element xacro:name='y${1}' w='2'/>",
        "<x v=\"2\"/><y1 w=\"2\"/>",
    ),
    // Substitutions.
    (
        "<xacro:arg name='given' default='1'/><xacro:arg name='other' default='2'/><x v='$(arg given)$(arg other)' w='${$(arg given) + 1}'/>",
        "<x v=\"72\" w=\"8\"/>",
    ),
    (
        "<x v='$(find pkg)/a' w='$(env SIDE) $(optenv NONE right) $(eval given * 2)'/>",
        "<x v=\"p/a\" w=\"left right 14\"/>",
    ),
    // Expressions.
    (
        "<x v='${[1, 2.5, \"a\"]}' w='${7 // -2} ${7 % -2} ${-7 / 2} ${2 ** -1} ${2 ** 3 ** 2}'/>",
        "<x v=\"[1, 2.5, 'a']\" w=\"-4 -1 -3.5 0.5 512\"/>",
    ),
    (
        "<x v='${round(2.5)} ${round(2.675, 2)} ${int(-3.9)} ${float(1)} ${str(1) + \"b\"} ${abs(-2)} ${min(3, 1)} ${max([1, 4])}'/>",
        "<x v=\"2 2.67 -3 1.0 1b 2 1 4\"/>",
    ),
    (
        "<x v='${radians(180) == pi} ${math.floor(2.7)} ${1 &lt; 2 &lt; 3} ${\"b\" in \"abc\"} ${1 if 0 else 2} ${0 or \"x\"} ${None is None}'/>",
        "<x v=\"True 2 True True 2 x True\"/>",
    ),
    (
        "<x v='${[i * 2 for i in range(4) if i != 1]} ${\"a-b\".split(\"-\")[1]} ${\"abc\"[::-1]} ${dict(a=1).get(\"b\", 3)}'/>",
        "<x v=\"[0, 4, 6] b cba 3\"/>",
    ),
    ("<x v='${1e16} ${1e-5} ${0.1 + 0.2} ${10 / 5}'/>", "<x v=\"1e+16 1e-05 0.30000000000000004 2.0\"/>"),
];

#[test]
fn xacro_is_expanded_as_xacro_does() {
    for (source, expected) in EXPANSIONS {
        assert_eq!(expanded(source, &[]), *expected, "{source}");
    }
}

#[test]
fn files_are_included_from_where_they_are() {
    let others = [
        (
            "w/sub/a.xacro",
            "<robot><xacro:include filename='b.xacro'/><xacro:property name='c' value=\"${xacro.load_yaml('../c.yaml')}\"/></robot>",
        ),
        (
            "w/sub/b.xacro",
            "<robot><xacro:macro name='m'><m/></xacro:macro><xacro:property name='b' value='1'/></robot>",
        ),
        ("w/c.yaml", "joints:\n  - {name: j, max: !degrees 180}\nbase: {mass: 1.5}\n"),
    ];
    let source = "<xacro:include filename='sub/a.xacro'/><xacro:include filename='none.xacro' optional='true'/>\
                  <xacro:include filename='sub/b.xacro' ns='n'/><xacro:m/><xacro:n.m/>\
                  <x v='${b} ${n.b} ${c.base.mass} ${c[\"joints\"][0][\"max\"] == pi}'/>";
    // The file of a property is where it is asked for, as in xacro itself.
    let lazy = source.replace("sub/a.xacro", "a.xacro");
    let others_here = [
        ("w/a.xacro", others[0].1.replace("../c", "c").replace("b.xacro", "sub/b.xacro")),
        ("w/sub/b.xacro", others[1].1.to_owned()),
        ("w/c.yaml", others[2].1.to_owned()),
    ];
    let here: Vec<(&str, &str)> = others_here.iter().map(|(path, text)| (*path, text.as_str())).collect();
    assert_eq!(expanded(&lazy, &here), "<m/><m/><x v=\"1 1 1.5 True\"/>");
    assert!(expanded(source, &others).starts_with("unreadable"));
}

#[test]
fn a_robot_is_read_with_all_that_it_has() {
    let text = "<robot name='r'>
      <material name='red'><color rgba='1 0 0 1'/></material>
      <link name='base'><visual><geometry><cylinder radius='1' length='2'/></geometry><material name='red'/></visual></link>
      <link name='arm'>
        <inertial><origin xyz='0 0 1' rpy='0 0 1'/><mass value='2'/><inertia ixx='1' ixy='0.1' ixz='0.2' iyy='1' iyz='0.3' izz='1'/></inertial>
        <collision name='c'><origin xyz='1 2 3'/><geometry><capsule radius='1' length='2'/></geometry></collision>
        <collision><geometry><box size='1 2 3'/></geometry></collision>
      </link>
      <link name='finger'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial></link>
      <joint name='turn' type='revolute'>
        <parent link='base'/><child link='arm'/><origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/><axis xyz='0 0 2'/>
        <limit lower='-1' upper='2' effort='3' velocity='4'/><dynamics damping='5' friction='6'/>
        <safety_controller soft_lower_limit='-0.9' soft_upper_limit='1.9' k_position='7' k_velocity='8'/>
      </joint>
      <joint name='slide' type='prismatic'>
        <parent link='arm'/><child link='finger'/><axis xyz='1 0 0'/><mimic joint='turn' multiplier='-2' offset='0.5'/>
        <limit lower='0' upper='1' effort='1' velocity='1'/>
      </joint>
      <transmission name='t'><type>Simple</type>
        <joint name='turn'><hardwareInterface>Position</hardwareInterface></joint>
        <actuator name='motor'><mechanicalReduction>50</mechanicalReduction></actuator>
      </transmission>
      <gazebo reference='arm'><selfCollide>true</selfCollide>
        <sensor name='scan' type='gpu_ray'><pose>0 0 1 0 0 0</pose><update_rate>10</update_rate>
          <ray><scan><horizontal><samples>360</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
          <range><min>0.1</min><max>10</max></range></ray></sensor></gazebo>
    </robot>";
    let mut files = SourceFiles::default();
    let reader = FilesInMemory::default().with("r.urdf", text);
    let robot = sound(&files.clone(), read(&reader, "r.urdf", &[], &PackageTable::new(), &mut files));
    assert_eq!((robot.links.len(), robot.joints.len(), robot.total_mass()), (3, 2, 3.0));
    assert_eq!(robot.links[0].visuals[0].color, Some([1.0, 0.0, 0.0, 1.0]));
    assert_eq!(robot.links[1].collisions[0].geometry, UrdfGeometry::Capsule { radius: 1.0, length: 2.0 });
    assert_eq!(robot.links[1].collisions[0].origin.xyz, [1.0, 2.0, 3.0]);
    assert_eq!((robot.links[1].collisions.len(), robot.links[1].self_collide), (2, Some(true)));
    assert_eq!(robot.links[1].inertial.unwrap().inertia.iyz, 0.3);
    let turn = &robot.joints[0];
    assert_eq!(
        (turn.axis, turn.dynamics.damping, turn.safety.unwrap().k_velocity),
        ([0.0, 0.0, 1.0], 5.0, 8.0)
    );
    assert_eq!(turn.limits.unwrap().velocity, Some(4.0));
    let transmission = &robot.transmissions[0];
    assert_eq!((transmission.kind.as_str(), transmission.actuators[0].reduction), ("Simple", Some(50.0)));
    assert_eq!(transmission.joints[0].hardware_interfaces, ["Position"]);
    let sensor = &robot.range_sensors[0];
    assert_eq!((sensor.horizontal.samples, sensor.range_max, sensor.origin.xyz[2]), (360, 10.0, 1.0));
    // A quarter turn by the origin, and one by the joint; the finger slides by 0.5 - 2 · π/2 along x, which now points back.
    let values = robot.joint_values([("turn", FRAC_PI_2)]).unwrap();
    let poses = robot.link_poses(&values);
    let slide = 0.5 - 2.0 * FRAC_PI_2;
    let [x, y, z] = poses[2].translation;
    assert!((x - (1.0 - slide)).abs() < 1e-12 && y.abs() < 1e-12 && z.abs() < 1e-12, "{x} {y} {z}");
    assert_eq!(robot.joint_values([("trun", 1.0)]).unwrap_err(), "no joint is called `trun`: write `turn`");
}

proptest! {
    /// Along a chain in a plane, angles add up, and places are sums of edges: an oracle without matrices.
    #[test]
    fn a_chain_in_a_plane_is_a_sum_of_edges(edges in vec((0.1..2.0f64, -3.0..3.0f64, any::<bool>()), 1..9)) {
        let mut text = String::from("<robot name='r'><link name='l0'/>");
        let body = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>";
        for (at, (length, _, reversed)) in edges.iter().enumerate() {
            let axis = if *reversed { -1 } else { 1 };
            text += &format!("<link name='l{}'>{body}</link><joint name='j{at}' type='revolute'><origin xyz='{length} 0 0'/>\
                <parent link='l{at}'/><child link='l{}'/><axis xyz='0 0 {axis}'/>\
                <limit lower='-4' upper='4' effort='1' velocity='1'/></joint>", at + 1, at + 1);
        }
        text += "</robot>";
        let mut files = SourceFiles::default();
        let reader = FilesInMemory::default().with("r.urdf", text);
        let robot = sound(&files.clone(), read(&reader, "r.urdf", &[], &PackageTable::new(), &mut files));
        let values: Vec<f64> = edges.iter().map(|(_, angle, _)| *angle).collect();
        let poses = robot.link_poses(&values);
        let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
        for (at, (length, angle, reversed)) in edges.iter().enumerate() {
            x += length * libm::cos(heading);
            y += length * libm::sin(heading);
            heading += if *reversed { -angle } else { *angle };
            let pose = &poses[at + 1];
            prop_assert!((pose.translation[0] - x).abs() < 1e-9 && (pose.translation[1] - y).abs() < 1e-9);
            prop_assert!((pose.rotation[0][0] - libm::cos(heading)).abs() < 1e-9);
        }
    }
}

fn binary_stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const DAE: &str = "<COLLADA><asset><unit meter='0.01'/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id='g'><mesh>
    <source id='p'><float_array id='f' count='12'>0 0 0 1 0 0 0 1 0 0 0 1</float_array>
      <technique_common><accessor source='#f' count='4' stride='3'/></technique_common></source>
    <vertices id='v'><input semantic='POSITION' source='#p'/></vertices>
    <triangles count='2'><input semantic='VERTEX' source='#v' offset='0'/><input semantic='NORMAL' source='#n' offset='1'/><p>0 0 2 0 1 0 0 0 1 0 3 0</p></triangles>
    <polylist count='2'><input semantic='VERTEX' source='#v' offset='0'/><vcount>3 3</vcount><p>0 3 2 1 2 3</p></polylist>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id='s'><node><translate>100 0 0</translate><scale>2 1 1</scale><instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url='#s'/></scene></COLLADA>";

#[test]
fn meshes_of_all_kinds_are_indexed_triangles_in_metres() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [1, 1, 2]];
    let triangles = faces.map(|face| face.map(|at: usize| corners[at].map(|n: f64| n as f32)));
    let mut text = String::from("solid a\n");
    for [a, b, c] in triangles {
        text += &format!(
            "facet normal 0 0 0\n outer loop\n  vertex {} {} {}\n  vertex {} {} {}\n  vertex {} {} {}\n endloop\nendfacet\n",
            a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]
        );
    }
    let mut obj: String = corners.iter().map(|c| format!("v {} {} {}\n", c[0], c[1], c[2])).collect();
    obj += &faces.map(|[a, b, c]| format!("f {}/1 -{}//2 {}\n", a + 1, 4 - b, c + 1)).concat();
    let tetrahedra = [
        read_mesh("a.STL", &binary_stl(&triangles)).unwrap(),
        read_mesh("a.stl", format!("{text}endsolid\n").as_bytes()).unwrap(),
        read_mesh("a.obj", obj.as_bytes()).unwrap(),
    ];
    for mesh in &tetrahedra {
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), mesh.up_axis), (4, 4, MeshAxis::Z));
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-12);
        // Mirrored it is still not inside out.
        assert!((mesh.scaled([-2.0, 1.0, 1.0]).volume() - 1.0 / 3.0).abs() < 1e-12);
    }
    assert_eq!(tetrahedra[0].digest(), tetrahedra[1].digest());
    assert_eq!(tetrahedra[0].digest(), "dd80eb9f4b06725ccf80f109297cfc23c242e01e3d8d945e8a51b1daf8527787");
    let dae = read_mesh("a.dae", DAE.as_bytes()).unwrap();
    let (low, high) = dae.bounds().unwrap();
    assert_eq!(
        (dae.triangles.len(), dae.up_axis, low, high),
        (4, MeshAxis::Y, [1.0, 0.0, 0.0], [1.02, 0.01, 0.01])
    );
    assert!((dae.volume() - 2e-6 / 6.0).abs() < 1e-15);
    assert_eq!(dae.upright().bounds().unwrap().0[1], -0.01);
}

#[test]
fn broken_meshes_are_errors_with_a_reason() {
    let mut short = binary_stl(&[[[0.0; 3]; 3]; 2]);
    short.truncate(100);
    let nan = binary_stl(&[[[f32::NAN; 3]; 3]]);
    let cases: [(&str, &[u8], &str); 10] = [
        ("a.stl", b"solid a\nvertex 1 2\n", "line 2"),
        ("a.stl", b"solid a\nfoo\n", "`foo`"),
        ("a.stl", &short, "2 triangles"),
        ("a.stl", &nan, "finite"),
        ("a.stl", b"", "short"),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n", "line 2"),
        ("a.obj", b"v 0 0 0\nf 1 1 1\n", "no triangle"),
        ("a.dae", b"<COLLADA>", ""),
        ("a.dae", b"<x/>", "`<x>`"),
        ("a.dae", DAE.as_bytes(), "leads to nothing"),
    ];
    for (path, bytes, word) in cases {
        let bytes = if word == "leads to nothing" {
            DAE.replace("url='#g'", "url='#h'").into_bytes()
        } else {
            bytes.to_vec()
        };
        let reason = read_mesh(path, &bytes).unwrap_err();
        assert!(reason.contains(word), "{path}: {reason}");
    }
}

#[test]
fn semantics_are_read_and_groups_have_their_joints() {
    let body = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>";
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for at in 0..4 {
        text += &format!(
            "<link name='l{}'>{body}</link><joint name='j{at}' type='revolute'><parent link='l{at}'/><child link='l{}'/><limit lower='-4' upper='4' effort='1' velocity='1'/></joint>",
            at + 1,
            at + 1
        );
    }
    let srdf = "<robot name='r'><group name='arm'><chain base_link='l0' tip_link='l2'/></group>
      <group name='hand'><joint name='j3'/></group><group name='all'><group name='hand'/><group name='arm'/><link name='l3'/></group>
      <group_state name='home' group='arm'><joint name='j0' value='0.5'/><joint name='j1' value='1'/></group_state>
      <end_effector name='e' parent_link='l3' group='hand' parent_group='arm'/>
      <virtual_joint name='v' type='planar' parent_frame='map' child_link='l0'/><passive_joint name='j1'/>
      <disable_collisions link1='l0' link2='l1' reason='Adjacent'/></robot>";
    let reader = FilesInMemory::default().with("r.urdf", text + "</robot>").with("r.srdf", srdf);
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let packages = PackageTable::new();
    let request = RobotRequest {
        semantics: Some(("r.srdf", place.into())),
        meshes: MeshChoice::None,
        ..RobotRequest::new("r.urdf", place, &packages)
    };
    let reading = read_robot(&request, &mut files, &reader);
    assert!(reading.faults.is_empty(), "{:?}", told(&files, &reading));
    let (robot, semantics) = (reading.robot.unwrap(), reading.semantics.unwrap());
    let joints = |group| semantics.joints_of(&robot, group).iter().map(|id| id.0).collect::<Vec<_>>();
    assert_eq!((joints("arm"), joints("hand"), joints("all")), (vec![0, 1], vec![3], vec![0, 1, 2, 3]));
    assert_eq!(
        semantics.states_of("arm").next().unwrap().values,
        [("j0".into(), vec![0.5]), ("j1".into(), vec![1.0])]
    );
    assert_eq!(semantics.end_effectors[0].parent_group.as_deref(), Some("arm"));
    assert_eq!((semantics.virtual_joints.len(), semantics.passive_joints.len()), (1, 1));
    assert_eq!(semantics.disabled_collisions[0].reason.as_deref(), Some("Adjacent"));
}

fn png_of(width: u32, height: u32, color: png::ColorType, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

#[test]
fn a_map_is_walls_where_its_picture_is_dark() {
    let yaml = "image: m.png\nresolution: 0.5\norigin: [10, 20, 1.5707963267948966]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    let picture = [0, 0, 255, 0, 0, 255, 255, 205, 0];
    let pgm = |head: &str| [head.as_bytes(), &picture].concat();
    let text = format!("P2 # by hand\n3 3\n255\n{}", picture.map(|n: u8| n.to_string()).join(" "));
    let rgb: Vec<u8> = picture.iter().flat_map(|n| [*n; 3]).collect();
    let pictures = [
        png_of(3, 3, png::ColorType::Grayscale, &picture),
        png_of(3, 3, png::ColorType::Rgb, &rgb),
        pgm("P5\n3 3\n255\n"),
        text.into_bytes(),
    ];
    for picture in pictures {
        let reader = FilesInMemory::default().with("w/m.yaml", yaml).with("w/m.png", picture);
        let mut files = SourceFiles::default();
        let place = Span::new(files.add("scenario", ""), 0, 0);
        let map = read_map("w/m.yaml", place, &mut files, &reader).unwrap();
        assert_eq!(
            (map.columns, map.rows, map.occupied, map.walls.len(), map.mode),
            (3, 3, 5, 2, MapMode::Trinary)
        );
        assert_eq!((map.walls[0].size, map.walls[1].size), ([1.0, 1.0], [0.5, 0.5]));
        // Two by two cells at the top left, a quarter turn to the left about the lower left corner.
        let [x, y] = map.walls[0].center;
        assert!((x - 9.0).abs() < 1e-12 && (y - 20.5).abs() < 1e-12, "{x} {y}");
    }
}
