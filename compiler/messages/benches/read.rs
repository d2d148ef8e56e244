//! How fast definitions are read: the standard packages as a library, and the table of a type with much in it.

use divan::{Bencher, counter::ItemsCount};
use hrdsl_messages::{InterfaceSpace, MessageLibrary, MessageLibraryBuilder, RosVersion};
use hrdsl_source::SourceFiles;

fn main() {
    divan::main();
}

const VERSIONS: [RosVersion; 2] = [RosVersion::Ros1, RosVersion::Ros2];

fn packages(version: RosVersion) -> &'static [(&'static str, &'static str)] {
    match version {
        RosVersion::Ros1 => hrdsl_stdlib::ROS1_PACKAGES,
        RosVersion::Ros2 => hrdsl_stdlib::ROS2_PACKAGES,
    }
}

fn library(version: RosVersion) -> MessageLibrary {
    let mut files = SourceFiles::default();
    let builder = MessageLibraryBuilder::new(version, &mut files);
    packages(version).iter().fold(builder, |builder, (name, text)| builder.package(name, name, text)).finish()
}

#[divan::bench(args = VERSIONS)]
fn standard(bencher: Bencher<'_, '_>, version: RosVersion) {
    let lines: usize = packages(version).iter().map(|(_, text)| text.lines().count()).sum();
    bencher.counter(ItemsCount::new(lines)).bench(|| library(version));
}

#[divan::bench(args = VERSIONS)]
fn move_group(bencher: Bencher<'_, '_>, version: RosVersion) {
    let library = library(version);
    let names: Vec<_> =
        library.find("moveit_msgs/MoveGroup", InterfaceSpace::Action).cloned().into_iter().collect();
    bencher.bench(|| library.closure(divan::black_box(&names)));
}
