//! Descriptions of robots, and maps, as they were read for a scenario: who names one gets what was read.

use std::sync::Arc;

use hrdsl_robots::{OccupancyMap, RobotReading};
use hrdsl_source::FileId;
use hrdsl_syntax::ast::{PartSyntax, WorldMemberKind};

/// What a part says of the description that it is made from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DescriptionRequest {
    pub path: String,
    /// Where packages are searched for.
    pub packages: Vec<String>,
    /// Of xacro.
    pub arguments: Vec<(String, String)>,
    pub semantics: Option<String>,
}

impl DescriptionRequest {
    /// That of a part; `None`: it is made from none.
    #[must_use]
    pub fn of(part: &PartSyntax) -> Option<Self> {
        let WorldMemberKind::Robot(path) = &part.description.as_ref()?.kind else { return None };
        let mut request = Self { path: path.text.clone(), ..Self::default() };
        for member in &part.members {
            if let WorldMemberKind::Packages(folder) = &member.kind {
                request.packages.push(folder.text.clone());
            } else if let WorldMemberKind::Argument { name, value } = &member.kind {
                request.arguments.push((name.text.clone(), value.text.clone()));
            } else if let WorldMemberKind::Semantics(path) = &member.kind {
                request.semantics = Some(path.text.clone());
            }
        }
        Some(request)
    }
}

/// All that was read, sound or not.
#[derive(Clone, Debug, Default)]
pub struct DescriptionLibrary {
    robots: Vec<(FileId, DescriptionRequest, Arc<RobotReading>)>,
    /// `None`: with a fault.
    maps: Vec<(FileId, String, Option<Arc<OccupancyMap>>)>,
}

impl DescriptionLibrary {
    /// Adds what the request of a file led to.
    pub fn add_robot(&mut self, file: FileId, request: DescriptionRequest, reading: RobotReading) {
        self.robots.push((file, request, Arc::new(reading)));
    }

    /// Adds what the path of a file led to.
    pub fn add_map(&mut self, file: FileId, path: String, map: Option<OccupancyMap>) {
        self.maps.push((file, path, map.map(Arc::new)));
    }

    /// Whether a file has asked for this.
    #[must_use]
    pub fn has_robot(&self, file: FileId, request: &DescriptionRequest) -> bool {
        self.robots.iter().any(|(of, known, _)| *of == file && known == request)
    }

    /// What was read for a request; one from a text that has changed since has the file of no other.
    #[must_use]
    pub fn robot(&self, file: FileId, request: &DescriptionRequest) -> Option<Arc<RobotReading>> {
        let same = || self.robots.iter().filter(|(_, known, _)| known == request);
        let found = same().find(|(of, ..)| *of == file).or_else(|| same().next());
        found.map(|(.., reading)| Arc::clone(reading))
    }

    /// The same of a map.
    #[must_use]
    pub fn map(&self, file: FileId, path: &str) -> Option<Arc<OccupancyMap>> {
        let same = || self.maps.iter().filter(|(_, known, _)| known == path);
        let found = same().find(|(of, ..)| *of == file).or_else(|| same().next());
        found.and_then(|(.., map)| map.clone())
    }
}
