//! Packages: where a description finds the files that it names by them, wherever one works.

mod common;

use common::{FilesInMemory, read, told};
use hrdsl_robots::{PackageTable, RobotEntry, RobotReader};
use hrdsl_source::{SourceFiles, Span};

#[test]
fn packages_are_found_by_their_manifests() {
    let manifest = |name: &str| format!("<package format='3'><name>{name}</name></package>");
    let reader = FilesInMemory::default()
        .with("ws/src/arm_description/package.xml", manifest("arm"))
        .with("ws/src/arm_description/meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .with("ws/src/again/package.xml", manifest("arm"))
        .with("ws/src/bad/package.xml", "<package/>")
        .with("ws/src/left_out/COLCON_IGNORE", "")
        .with("ws/src/left_out/package.xml", manifest("other"))
        .with("ws/r.urdf", "<robot name='r'><link name='a'><collision><geometry><mesh filename='package://arm/meshes/a.obj'/></geometry></collision></link></robot>");
    let mut files = SourceFiles::default();
    let place = Span::new(files.add("scenario", ""), 0, 0);
    let mut packages = PackageTable::new();
    let faults = packages.search(&reader, &mut files, "ws", place.into());
    let words: Vec<&str> = faults.iter().map(|fault| fault.kind.word()).collect();
    assert_eq!(words, ["duplicate-package", "malformed-manifest"]);
    assert_eq!(packages.iter().collect::<Vec<_>>(), [("arm", "ws/src/again")]);
    let packages = PackageTable::new().with("arm", "ws/src/arm_description");
    let reading = read(&reader, "ws/r.urdf", &[], &packages, &mut files);
    assert_eq!(reading.meshes.keys().collect::<Vec<_>>(), ["ws/src/arm_description/meshes/a.obj"]);
    assert!(reading.is_sound());
    // Without a table, a folder above the description that is called as the package will do.
    let beside = FilesInMemory(
        reader
            .0
            .iter()
            .map(|(path, bytes)| (path.replace("src/arm_description", "arm"), bytes.clone()))
            .collect(),
    );
    assert!(read(&beside, "ws/r.urdf", &[], &PackageTable::new(), &mut files).is_sound());
}

/// Files whose paths start from a folder somewhere.
struct WorkedIn(FilesInMemory, &'static str);

impl WorkedIn {
    fn named(&self, path: &str) -> String {
        let inside = path.strip_prefix(self.1).and_then(|rest| rest.strip_prefix('/'));
        inside.unwrap_or(path).to_owned()
    }
}

impl RobotReader for WorkedIn {
    fn bytes(&self, file: &str) -> Result<Vec<u8>, String> {
        self.0.bytes(&self.named(file))
    }

    fn entries(&self, folder: &str) -> Result<Vec<RobotEntry>, String> {
        self.0.entries(&self.named(folder))
    }

    fn working_folder(&self) -> String {
        self.1.to_owned()
    }
}

/// A description asks for its package in one file, and names files by it in others. Wherever one works, and with whatever path the
/// description is named, its files are found, and told by their paths from there.
#[test]
fn a_package_is_found_from_each_file_that_is_told_its_folder() {
    let urdf = "<robot name='r' xmlns:xacro='x'>
      <xacro:property name='folder' value='$(find arm)'/>
      <xacro:include filename='$(find arm)/urdf/parts/a.xacro'/>
      <xacro:include filename='$(dirname)/parts/b.xacro'/>
      <xacro:property name='c' value=\"${xacro.load_yaml(folder + '/c.yaml')}\"/>
      <link name='a${c.n}'><collision><geometry><mesh filename='file://$(find arm)/meshes/a.obj'/></geometry></collision></link>
    </robot>";
    let within = "<robot><xacro:include filename='${folder}/urdf/parts/b.xacro'/></robot>";
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let package = [
        ("urdf/r.xacro", urdf),
        ("urdf/parts/a.xacro", within),
        ("urdf/parts/b.xacro", "<robot/>"),
        ("c.yaml", "n: 3\n"),
        ("meshes/a.obj", mesh),
    ];
    // The folder where one works, how the package's files are named from there, and which of them says its name.
    for (here, before, manifest) in [
        ("/ws", "src/arm/", None),
        ("/ws/src/arm", "", None),
        ("/ws/src/of_the_arm", "", Some("package.xml")),
        ("/ws", "src/of_the_arm/", Some("src/of_the_arm/package.xml")),
        ("/elsewhere", "/ws/src/arm/", None),
    ] {
        let files = package.iter().fold(FilesInMemory::default(), |files, (path, text)| {
            files.with(&format!("{before}{path}"), *text)
        });
        let files = match manifest {
            Some(path) => files.with(path, "<package><name>arm</name></package>"),
            None => files,
        };
        let (reader, mut sources) = (WorkedIn(files, here), SourceFiles::default());
        let reading =
            read(&reader, &format!("{before}urdf/r.xacro"), &[], &PackageTable::new(), &mut sources);
        assert_eq!(told(&sources, &reading), Vec::<String>::new(), "{here} {before}");
        assert_eq!(reading.robot.unwrap().links[0].name, "a3");
        assert_eq!(reading.meshes.keys().collect::<Vec<_>>(), [&format!("{before}meshes/a.obj")]);
        let named = ["urdf/r.xacro", "urdf/parts/a.xacro", "urdf/parts/b.xacro"];
        assert_eq!(reading.files[..3], named.map(|path| format!("{before}{path}")), "{here}");
    }
}
