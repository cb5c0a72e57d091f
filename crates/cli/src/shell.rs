//! `bulge completions` and `bulge man`: what a shell and a manual know of the command line.

use clap::{Args, Command, CommandFactory};
use clap_complete::{Shell, generate};
use std::path::PathBuf;

use crate::Arguments;
use crate::failure::Failure;
use crate::files;

/// Completions for a shell, on standard output.
///
/// For bash: `bulge completions bash > ~/.local/share/bash-completion/completions/bulge`. For zsh: into a folder of `fpath`, as `_bulge`. For fish: `bulge completions
/// fish > ~/.config/fish/completions/bulge.fish`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsCommand {
    /// The shell
    shell: Shell,
}

impl CompletionsCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut whole(), "bulge", &mut script);
        files::print(&script).map_err(|source| Failure::Output { path: "standard output".into(), source })?;
        Ok(String::new())
    }
}

/// Manual pages, one for each command: bulge.1, bulge-compare.1 and so on.
///
/// `bulge man ~/.local/share/man/man1`, then `man bulge-compare`.
#[derive(Debug, Args)]
pub(crate) struct ManCommand {
    /// Folder of the pages
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl ManCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let pages = pages(&whole())
            .map_err(|source| Failure::Output { path: self.folder.clone(), source })?
            .into_iter()
            .map(|(name, page)| (self.folder.join(name), page))
            .collect::<Vec<_>>();
        let contents: Vec<(PathBuf, &str)> =
            pages.iter().map(|(path, page)| (path.clone(), page.as_str())).collect();
        files::write_all(&self.folder, &contents)?;
        Ok(format!("  wrote {} pages below {}\n", pages.len(), self.folder.display()))
    }
}

/// The command line, under its own name, whatever the file of the program is called.
fn whole() -> Command {
    Arguments::command().name("bulge").bin_name("bulge")
}

/// Names and texts of the pages of a command and of all below it.
fn pages(whole: &Command) -> std::io::Result<Vec<(String, String)>> {
    let mut command = whole.clone().disable_help_subcommand(true);
    command.build();
    let mut waiting = vec![command];
    let mut pages = Vec::new();
    while let Some(command) = waiting.pop() {
        let page = clap_mangen::Man::new(command.clone());
        let mut text = Vec::new();
        page.render(&mut text)?;
        pages.push((page.get_filename(), String::from_utf8_lossy(&text).into_owned()));
        waiting.extend(command.get_subcommands().cloned());
    }
    pages.sort();
    Ok(pages)
}
