//! What holds of every input: expressions have the value that arithmetic gives them, and whatever is read, nothing panics.
//!
//! `HRDSL_CASES=100000 cargo test -p hrdsl-robots --test properties` looks for longer.

#![allow(clippy::disallowed_methods, reason = "the number of cases is taken from the environment")]

mod common;

use common::FilesInMemory;
use hrdsl_robots::{
    MeshChoice, PackageTable, RobotReader, RobotRequest, expanded_text, read_map, read_mesh, read_robot,
};
use hrdsl_source::{SourceFiles, Span};
use proptest::{collection::vec, prelude::*, sample::select};

fn cases() -> ProptestConfig {
    let cases = std::env::var("HRDSL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(400);
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

/// An expression, and the oracle's own view of it: whole numbers of 128 bits, and floats.
#[derive(Clone, Debug)]
enum Sum {
    Whole(i32),
    Real(f64),
    Minus(Box<Sum>),
    Two(&'static str, Box<Sum>, Box<Sum>),
    Choice(Box<Sum>, Box<Sum>, Box<Sum>),
    Call(&'static str, Box<Sum>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Whole(i128),
    Real(f64),
}

impl Number {
    fn real(self) -> f64 {
        match self {
            Number::Whole(n) => n as f64,
            Number::Real(x) => x,
        }
    }
}

fn sums() -> impl Strategy<Value = Sum> {
    let leaf = prop_oneof![
        (0..50i32).prop_map(Sum::Whole),
        (0..800u32).prop_map(|n| Sum::Real(f64::from(n) / 16.0))
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let operators = select(vec!["+", "-", "*", "/", "//", "%", "<", "<=", "==", "!=", "and", "or"]);
        prop_oneof![
            inner.clone().prop_map(|a| Sum::Minus(Box::new(a))),
            (operators, inner.clone(), inner.clone()).prop_map(|(o, a, b)| Sum::Two(
                o,
                Box::new(a),
                Box::new(b)
            )),
            (inner.clone(), inner.clone(), inner.clone()).prop_map(|(a, b, c)| Sum::Choice(
                Box::new(a),
                Box::new(b),
                Box::new(c)
            )),
            (select(vec!["abs", "float", "int", "round"]), inner)
                .prop_map(|(f, a)| Sum::Call(f, Box::new(a))),
        ]
    })
}

/// How tight an expression binds.
fn level(sum: &Sum) -> u8 {
    match sum {
        Sum::Choice(..) => 0,
        Sum::Two("or", ..) => 1,
        Sum::Two("and", ..) => 2,
        Sum::Two("<" | "<=" | "==" | "!=", ..) => 4,
        Sum::Two("+" | "-", ..) => 5,
        Sum::Two(..) => 6,
        Sum::Minus(_) => 7,
        Sum::Whole(_) | Sum::Real(_) | Sum::Call(..) => 8,
    }
}

/// With no more parentheses than are needed.
fn written(sum: &Sum) -> String {
    let at_least = |inner: &Sum, least: u8| {
        if level(inner) < least { format!("({})", written(inner)) } else { written(inner) }
    };
    match sum {
        Sum::Whole(n) => n.to_string(),
        Sum::Real(x) => format!("{x:?}"),
        Sum::Minus(a) => format!("-{}", at_least(a, 7)),
        Sum::Two(o, a, b) => {
            let own = level(sum);
            // Comparisons would make a chain, so that both sides need parentheses.
            let left = if own == 4 { 5 } else { own };
            format!("{} {o} {}", at_least(a, left), at_least(b, own + 1))
        }
        Sum::Choice(c, a, b) => format!("{} if {} else {}", at_least(a, 1), at_least(c, 1), written(b)),
        Sum::Call(f, a) => format!("{f}({})", written(a)),
    }
}

/// `None` where Python has no value, or one that the oracle does not know.
fn value(sum: &Sum) -> Option<Number> {
    use Number::{Real, Whole};
    let truth = |n: Number| n.real() != 0.0;
    Some(match sum {
        Sum::Whole(n) => Whole(i128::from(*n)),
        Sum::Real(x) => Real(*x),
        Sum::Minus(a) => match value(a)? {
            Whole(n) => Whole(-n),
            Real(x) => Real(-x),
        },
        Sum::Two("and", a, b) => {
            let a = value(a)?;
            if truth(a) { value(b)? } else { a }
        }
        Sum::Two("or", a, b) => {
            let a = value(a)?;
            if truth(a) { a } else { value(b)? }
        }
        Sum::Two(o, a, b) => match (*o, value(a)?, value(b)?) {
            ("<", a, b) => Whole(i128::from(a.real() < b.real())),
            ("<=", a, b) => Whole(i128::from(a.real() <= b.real())),
            ("==", a, b) => Whole(i128::from(a.real() == b.real())),
            ("!=", a, b) => Whole(i128::from(a.real() != b.real())),
            ("/" | "//" | "%", _, b) if b.real() == 0.0 => return None,
            ("+", Whole(a), Whole(b)) => Whole(a + b),
            ("-", Whole(a), Whole(b)) => Whole(a - b),
            ("*", Whole(a), Whole(b)) => Whole(a * b),
            ("//", Whole(a), Whole(b)) => Whole((a - (a % b + b) % b) / b),
            ("%", Whole(a), Whole(b)) => Whole((a % b + b) % b),
            ("+", a, b) => Real(a.real() + b.real()),
            ("-", a, b) => Real(a.real() - b.real()),
            ("*", a, b) => Real(a.real() * b.real()),
            ("/", a, b) => Real(a.real() / b.real()),
            // With points, Python's own definition is the only one; the whole numbers above show the signs.
            _ => return None,
        },
        Sum::Choice(c, a, b) => {
            if truth(value(c)?) {
                value(a)?
            } else {
                value(b)?
            }
        }
        Sum::Call("abs", a) => match value(a)? {
            Whole(n) => Whole(n.abs()),
            Real(x) => Real(x.abs()),
        },
        Sum::Call("float", a) => Real(value(a)?.real()),
        Sum::Call("int", a) => Whole(value(a)?.real() as i128),
        Sum::Call(_, a) => match value(a)? {
            Whole(n) => Whole(n),
            Real(x) => Whole(x.round_ties_even() as i128),
        },
    })
}

/// What an expression comes to in a description.
fn computed(expression: &str) -> Option<String> {
    let escaped = expression.replace('<', "&lt;");
    let reader = FilesInMemory::default().with("r.xacro", format!("<robot name=\"{{}}${{{escaped}}}\"/>"));
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let packages = PackageTable::new();
    let text = expanded_text(&RobotRequest::new("r.xacro", place, &packages), &mut files, &reader).ok()?;
    Some(text.strip_prefix("<robot name=\"{}")?.strip_suffix("\"/>")?.to_owned())
}

const URDF: &str = "<?xml version='1.0'?><robot name='r'><material name='m'><color rgba='1 0 0 1'/></material><link name='a'><visual>
  <geometry><mesh filename='m.stl' scale='1 1 1'/></geometry></visual></link><link name='b'><inertial><origin xyz='0 0 1'/>
  <mass value='2'/><inertia ixx='1' iyy='1' izz='1'/></inertial><collision><geometry><box size='1 2 3'/></geometry></collision></link>
  <joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1'
  velocity='1'/><mimic joint='k'/></joint><link name='c'/><joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint></robot>";
const XACRO: &str = "<robot name='r' xmlns:xacro='x'><xacro:property name='p' value='${2 * pi}'/><xacro:arg name='a' default='1'/>
  <xacro:macro name='m' params='n:=1 *b c:=^|2'><link name='l${n}'><xacro:insert_block name='b'/></link>
  <xacro:if value='${n &lt; 3}'><xacro:m n='${n + 1}'><x/></xacro:m></xacro:if></xacro:macro><xacro:m><x v='$(arg a)'/></xacro:m>
  <xacro:property name='y' value=\"${xacro.load_yaml('y.yaml')}\"/><l v='${y.a[0]} ${[i for i in range(3)]} ${\"a b\".split()}'/>
  <xacro:include filename='r.urdf'/></robot>";
const YAML: &str = "# m\nimage: m.pgm\nresolution: 0.1\norigin: [0, 0, 0.5]\nmode: trinary\na:\n  - 1\n  - {b: !degrees 2, c: 'd'}\n";
const SRDF: &str = "<robot name='r'><group name='g'><joint name='j'/><chain base_link='a' tip_link='c'/></group>
  <group_state name='s' group='g'><joint name='j' value='0'/></group_state><disable_collisions link1='a' link2='b'/></robot>";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2//2 -1\n";
const DAE: &str = "<COLLADA><asset><unit meter='1'/></asset><library_geometries><geometry id='g'><mesh><source id='p'>
  <float_array>0 0 0 1 0 0 0 1 0</float_array></source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices>
  <polylist><input semantic='VERTEX' source='#v' offset='0'/><vcount>3</vcount><p>0 1 2</p></polylist></mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id='s'><node id='n'><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url='#g'/>
  </node></visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";

fn sources() -> Vec<(&'static str, Vec<u8>)> {
    let mut stl = vec![b' '; 80];
    stl.extend(1u32.to_le_bytes());
    stl.extend([0, 0, 128, 63].repeat(12));
    stl.extend([0; 2]);
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 2);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    encoder.write_header().unwrap().write_image_data(&[0, 255, 9, 0, 255, 255, 100, 3]).unwrap();
    let texts = [
        ("r.urdf", URDF),
        ("r.xacro", XACRO),
        ("y.yaml", YAML),
        ("r.srdf", SRDF),
        ("m.obj", OBJ),
        ("m.dae", DAE),
    ];
    let more = [
        ("m.stl", stl),
        ("t.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid".to_vec()),
        ("m.pgm", b"P5 2 2 255\n\0\x01\x02\xff".to_vec()),
        ("p.pgm", b"P2\n# c\n2 2\n255\n0 1 2 255".to_vec()),
        ("m.png", png),
    ];
    texts.into_iter().map(|(name, text)| (name, text.as_bytes().to_vec())).chain(more).collect()
}

/// Changes of some bytes: replaced, taken out, doubled, cut off.
fn mutated(mut bytes: Vec<u8>, changes: &[(usize, u8, u8)]) -> Vec<u8> {
    const SIGNS: &[u8] = b"<>/\"'${}()[]*-+.,:#&!| \n019eEnaxacro:\0\xff";
    for (at, kind, byte) in changes {
        if bytes.is_empty() {
            break;
        }
        let at = at % bytes.len();
        let sign = SIGNS[usize::from(*byte) % SIGNS.len()];
        match kind % 6 {
            0 => bytes[at] = *byte,
            1 => bytes[at] = sign,
            2 => bytes.insert(at, sign),
            3 => drop(bytes.remove(at)),
            4 => {
                let end = (at + usize::from(*byte)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => bytes.truncate(at.max(bytes.len() / 2)),
        }
    }
    bytes
}

fn read_everything(reader: &FilesInMemory) {
    let packages = PackageTable::new().with("p", "p");
    for path in ["r.urdf", "r.xacro"] {
        let mut files = SourceFiles::default();
        let place = Span::new(files.add("scenario", ""), 0, 0);
        let request = RobotRequest {
            semantics: Some(("r.srdf", place.into())),
            meshes: MeshChoice::All,
            ..RobotRequest::new(path, place, &packages)
        };
        let reading = read_robot(&request, &mut files, reader);
        for fault in &reading.faults {
            // Each place lies within its file, between characters.
            let file = files.get(fault.place.span.file).unwrap();
            assert!(file.text.get(fault.place.span.range()).is_some(), "{fault:?}");
            assert!(!fault.help.is_empty() && !fault.kind.to_string().is_empty());
        }
        if let Some(robot) = reading.robot {
            let poses = robot.link_poses(&vec![0.3; robot.joints.len()]);
            assert!(poses.iter().all(|pose| pose.translation.iter().all(|x| !x.is_nan())));
        }
    }
    for (path, bytes) in &reader.0 {
        if let Ok(mesh) = read_mesh(path, bytes) {
            assert!(mesh.triangles.iter().all(|triangle| mesh.corners(*triangle).is_some()));
        }
    }
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("scenario", ""), 0, 0);
    for picture in ["m.pgm", "p.pgm", "m.png"] {
        let yaml = String::from_utf8_lossy(&reader.0["y.yaml"]).replace("m.pgm", picture);
        let reader = reader.clone().with("map.yaml", yaml);
        let _ = read_map("map.yaml", place, &mut files, &reader);
    }
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn expressions_have_the_value_that_arithmetic_gives_them(sum in sums()) {
        let expression = written(&sum);
        let Some(expected) = value(&sum) else { return Ok(()) };
        let found = computed(&expression);
        let Some(found) = found else {
            // Only what no 64 bits hold has no value here.
            prop_assert!(expression.contains('*') || expression.contains("int"), "{} has no value", expression);
            return Ok(());
        };
        match (found.as_str(), expected) {
            ("True" | "False", expected) => prop_assert_eq!(found == "True", expected == Number::Whole(1), "{}", expression),
            (found, Number::Whole(n)) => prop_assert_eq!(found, n.to_string(), "{}", expression),
            (found, Number::Real(x)) => {
                let read: f64 = found.parse().unwrap();
                prop_assert!(read.to_bits() == x.to_bits(), "{}: {} and not {:?}", expression, found, x);
            }
        }
    }

    #[test]
    fn no_input_panics(which in 0usize..11, changes in vec((any::<usize>(), any::<u8>(), any::<u8>()), 1..8)) {
        let sources = sources();
        let mut reader = FilesInMemory::default();
        for (at, (name, bytes)) in sources.into_iter().enumerate() {
            let bytes = if at == which { mutated(bytes, &changes) } else { bytes };
            reader = reader.with(name, bytes);
        }
        read_everything(&reader);
        prop_assert!(reader.bytes("r.urdf").is_ok());
    }

    #[test]
    fn no_expression_panics(expression in "[-+*/%(){\\[\\]}., 0-9a-e'\"<>=!]{0,30}|(1|2\\.5|a|\\[|\\]|\\(|\\)| if | else | for x in |not |-|\\*\\*|//|:|,|'b'|\\.|min|range|len){0,14}") {
        let _ = computed(&expression.replace('"', "&quot;"));
    }
}

#[test]
fn what_grows_without_bounds_is_stopped() {
    let doubling = |from: &str, join: &str| {
        let mut text = format!("<xacro:property name='p0' value='{from}'/>");
        for at in 0..80 {
            text += &format!(
                "<xacro:property name='p{}' value='${{{}}}'/>",
                at + 1,
                join.replace('p', &format!("p{at}"))
            );
        }
        format!("<robot name='${{p80}}'>{text}<link name='${{p80}}'/></robot>")
    };
    let sources = [
        doubling("abcdefgh", "p + p"),
        doubling("${[1, 2]}", "[p, p]"),
        doubling("${[1, 2]}", "p + p"),
        doubling("3", "p * p"),
        doubling("ab", "p * 1000000"),
        "<robot name='r'><xacro:macro name='m'><a/><xacro:m/><xacro:m/></xacro:macro><xacro:m/></robot>".to_owned(),
        "<robot name='${[[[[y for y in range(1000)] for x in range(1000)] for z in range(1000)] for w in range(1000)]}'/>".to_owned(),
        format!("<robot name='${{{}1{}}}'/>", "(".repeat(5000), ")".repeat(5000)),
        format!("<robot name='${{{}1}}'/>", "-".repeat(5000)),
        format!("<robot name='${{{}}}'/>", vec!["1"; 5000].join("+")),
    ];
    for source in sources {
        let reader = FilesInMemory::default().with("r.xacro", source.as_bytes());
        let mut files = SourceFiles::default();
        let place = Span::new(files.add("scenario", ""), 0, 0);
        let packages = PackageTable::new();
        let reading = read_robot(&RobotRequest::new("r.xacro", place, &packages), &mut files, &reader);
        assert!(!reading.is_sound(), "{}", &source[..80]);
    }
}
