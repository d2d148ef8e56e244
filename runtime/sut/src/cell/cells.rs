//! How the cells of a campaign are made: found out once, before its first test.

use std::path::{Path, PathBuf};

use super::{
    handle::{CellHandle, SupervisorCommand},
    message::{CellIsolation, CellOrder},
};
use crate::{error::SutError, limits::ProgramLimits};

/// What all cells of a campaign have in common.
#[derive(Clone, Debug)]
pub struct CellSettings {
    pub supervisor: SupervisorCommand,
    pub isolation: CellIsolation,
    /// Folders that the programs do not see: the results of earlier and of this campaign.
    pub hidden: Vec<PathBuf>,
    /// Whether the machine's network is the programs', too.
    pub network: bool,
    /// Whether the program keeps the terminal, for a debugger.
    pub terminal: bool,
    /// What cannot be kept apart on this machine, in whole sentences; to be said once.
    pub gaps: Vec<String>,
}

impl CellSettings {
    /// Makes a cell for the project's folder, with nothing in it: of the wanted kind, or else with namespaces if the
    /// machine allows them, and with copies if not.
    ///
    /// # Errors
    /// [`SutError::Io`] if no cell can be made, or not one of the kind that is wanted.
    pub fn probe(
        supervisor: SupervisorCommand,
        project: &Path,
        wanted: Option<CellIsolation>,
    ) -> Result<Self, SutError> {
        let isolation = wanted.unwrap_or(CellIsolation::Namespaces);
        let mut cells = Self {
            supervisor,
            isolation,
            hidden: Vec::new(),
            network: false,
            terminal: false,
            gaps: Vec::new(),
        };
        let cell = match cells.empty_cell(project) {
            Ok(cell) => cell,
            Err(refusal) if wanted.is_some() => return Err(refusal),
            Err(refusal) => {
                cells.isolation = CellIsolation::Copies;
                cells.gaps.push(format!("namespaces cannot be had here ({refusal})"));
                cells.empty_cell(project)?
            }
        };
        cells.gaps.extend(cells.gaps_of(&cell));
        Ok(cells)
    }

    fn empty_cell(&self, project: &Path) -> Result<CellHandle, SutError> {
        let dir =
            project.canonicalize().map_err(SutError::io(format!("cannot find {}", project.display())))?;
        let order = CellOrder {
            isolation: self.isolation,
            command: Vec::new(),
            env: Vec::new(),
            dir: dir.into_os_string(),
            hidden: Vec::new(),
            descriptors: Vec::new(),
            memory: ProgramLimits::default().memory,
            keep: false,
            network: self.network,
            terminal: self.terminal,
        };
        Ok(CellHandle::start(&self.supervisor, &order, &[])?)
    }

    fn gaps_of(&self, cell: &CellHandle) -> Vec<String> {
        let mut gaps = Vec::new();
        if self.isolation == CellIsolation::Copies {
            gaps.push(
                "each program runs in a copy of its folder: what it writes to absolute paths elsewhere, its process numbers and its \
                 network are not kept apart from other tests"
                    .to_owned(),
            );
        }
        if !cell.fixed_addresses {
            gaps.push(
                "the system refuses fixed addresses: what follows from the addresses of objects in memory (the order of sets of \
                 objects, `id`) may differ between runs"
                    .to_owned(),
            );
        }
        if !cell.read_only.is_empty() {
            let folders: Vec<_> = cell.read_only.iter().map(|f| f.to_string_lossy()).collect();
            gaps.push(format!(
                "no private copy can be laid over {}: programs cannot write there",
                folders.join(", ")
            ));
        }
        gaps
    }
}
