//! `bulge keys`: the files that commands read, each with every key.

use bulge_design::joint::JOINT_EXAMPLE;
use bulge_effects::user;
use bulge_inference::PROTOCOL_EXAMPLE;
use bulge_measurements::recognised_columns;
use bulge_membrane::case::CASE_EXAMPLE;
use bulge_muscles::{BRAIDED_EXAMPLE, PLEATED_EXAMPLE};
use bulge_sweep::SWEEP_EXAMPLE;
use clap::{Args, ValueEnum};
use serde_json::json;

use crate::arguments::Json;
use crate::failure::Failure;
use crate::text::table;

/// A file with every key, and what each means: to start from, or to look up.
///
/// `bulge keys braided > my.toml`; without a name all are listed.
#[derive(Debug, Args)]
pub(crate) struct KeysCommand {
    /// The kind of file
    file: Option<FileArgument>,
    #[command(flatten)]
    json: Json,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FileArgument {
    /// A muscle file of a braid (McKibben, Festo)
    Braided,
    /// A muscle file of a pleated muscle (PPAM)
    Pleated,
    /// Columns of measurements, and the words by which they are recognised
    Data,
    /// Effects of your own
    Effects,
    /// What a test bench does, for `simulate` and `plan`
    Protocol,
    /// A family of muscles, and the table of it
    Sweep,
    /// Two muscles on a joint
    Joint,
    /// A case of membrane elements
    Membrane,
}

impl FileArgument {
    fn text(self) -> String {
        match self {
            Self::Braided => BRAIDED_EXAMPLE.to_owned(),
            Self::Pleated => PLEATED_EXAMPLE.to_owned(),
            Self::Data => columns(),
            Self::Effects => format!("{}\n{}", user::EXAMPLE, user::SHAPE_EXAMPLE),
            Self::Protocol => PROTOCOL_EXAMPLE.to_owned(),
            Self::Sweep => SWEEP_EXAMPLE.to_owned(),
            Self::Joint => JOINT_EXAMPLE.to_owned(),
            Self::Membrane => CASE_EXAMPLE.to_owned(),
        }
    }

    /// Name and description, as the help has them.
    fn said(self) -> (String, String) {
        let value = self.to_possible_value();
        let name = value.as_ref().map_or_else(String::new, |value| value.get_name().to_owned());
        let about =
            value.as_ref().and_then(|value| value.get_help()).map_or_else(String::new, ToString::to_string);
        (name, about)
    }
}

impl KeysCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let Some(file) = self.file else {
            let all: Vec<(String, String)> =
                FileArgument::value_variants().iter().map(|file| file.said()).collect();
            let files: Vec<_> =
                all.iter().map(|(name, about)| json!({ "file": name, "about": about })).collect();
            let document = json!({ "schema": "bulge.files/1", "files": files });
            let rows: Vec<Vec<String>> = all.into_iter().map(|(name, about)| vec![name, about]).collect();
            return self.json.or(&document, || table(&rows) + "\n  bulge keys FILE shows one\n");
        };
        let (name, about) = file.said();
        let document =
            json!({ "schema": "bulge.keys/1", "file": name, "about": about, "example": file.text() });
        self.json.or(&document, || file.text())
    }
}

/// The columns of a data file.
fn columns() -> String {
    let heading = ["column", "what it is", "units", "recognised by"].map(str::to_owned).to_vec();
    let rows = recognised_columns().into_iter().map(|column| {
        let words = column.words.join(", ");
        vec![column.heading.to_owned(), column.about.to_owned(), column.units.join(" "), words]
    });
    table(&std::iter::once(heading).chain(rows).collect::<Vec<_>>())
}
