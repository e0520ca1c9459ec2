//! Lays out the manual of fakir with mdBook, and turns its formulas from TeX to MathML.
//!
//! `fakir-manual theory FROM TO` writes the pages of theory with formulas that rustdoc can show;
//! with `--check` it writes nothing and fails if they are not what is there.
//! `fakir-manual build BOOK PAGES OUTPUT` makes the book of pages that have been run.

mod links;
mod mathematics;

use mdbook_driver::MDBook;
use mdbook_driver::book::Book;
use mdbook_driver::config::Config;
use mdbook_driver::errors::Error;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["theory", from, to] => theory(Path::new(from), Path::new(to), false),
        ["theory", from, to, "--check"] => theory(Path::new(from), Path::new(to), true),
        ["build", book, pages, output] => build(book, pages, output),
        _ => Err("usage: fakir-manual theory FROM TO [--check]\n       \
                  fakir-manual build BOOK PAGES OUTPUT"
            .to_owned()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

/// Every page of theory with its formulas as MathML.
fn theory(from: &Path, to: &Path, check: bool) -> Result<(), String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(from).map_err(|error| at(from, &error))? {
        let path = entry.map_err(|error| at(from, &error))?.path();
        if path.extension().is_some_and(|extension| extension == "md") {
            names.extend(path.file_name().map(ToOwned::to_owned));
        }
    }
    for name in names {
        let source = from.join(&name);
        let text = fs::read_to_string(&source).map_err(|error| at(&source, &error))?;
        let rendered = mathematics::render(&text).map_err(|error| at(&source, &error))?;
        let target = to.join(&name);
        // A page that is the same is left alone, as the library is compiled again where one is newer.
        if fs::read_to_string(&target).is_ok_and(|known| known == rendered) {
            continue;
        }
        if !check {
            fs::create_dir_all(to).map_err(|error| at(to, &error))?;
            fs::write(&target, rendered).map_err(|error| at(&target, &error))?;
        } else {
            return Err(format!(
                "{} is not what {} gives: run cargo xtask book --update",
                target.display(),
                source.display()
            ));
        }
    }
    Ok(())
}

/// The book: its settings in the file `book`, its pages in a folder.
fn build(book: &str, pages: &str, output: &str) -> Result<(), String> {
    let make = || -> Result<(), Error> {
        let mut config = Config::from_disk(book)?;
        config.book.src = fs::canonicalize(pages)?;
        config.build.build_dir = std::path::absolute(output)?;
        config.build.create_missing = false;
        let root = Path::new(book).parent().unwrap_or(Path::new("."));
        let mut book = MDBook::load_with_config(root, config)?;
        book.with_preprocessor(Mathematics);
        book.build()
    };
    make().map_err(|error| format!("{error:#}"))?;
    links::check(Path::new(output))
}

/// Formulas of pages as MathML.
struct Mathematics;

impl Preprocessor for Mathematics {
    fn name(&self) -> &str {
        "mathematics"
    }

    fn run(&self, _: &PreprocessorContext, mut book: Book) -> Result<Book, Error> {
        let mut problems = Vec::new();
        book.for_each_chapter_mut(|chapter| match mathematics::render(&chapter.content) {
            Ok(text) => chapter.content = text,
            Err(problem) => problems.push(format!("{}: {problem}", chapter.name)),
        });
        if problems.is_empty() {
            Ok(book)
        } else {
            Err(Error::msg(problems.join("\n")))
        }
    }
}

fn at(path: &Path, error: &impl std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}
