//! Tables from XLSX files: the sheet that has the most rows of numbers, as text with tabs between its cells.

use crate::archive::member;
use crate::markup::{Part, attribute, parts};

/// A sheet as text.
struct Sheet {
    name: String,
    table: String,
    /// The first cell with a formula whose value is not in the file.
    formula: Option<String>,
    /// The first row that is hidden.
    hidden: Option<usize>,
    /// Number of rows with two numbers, which notes on a measurement do not have.
    rows: usize,
}

/// The table of an XLSX file as text: one line for each row of the sheet, so that line numbers are row numbers. Without a name of a sheet, it
/// is that with the most rows of numbers.
///
/// # Errors
/// A description of the error: a damaged archive, a part that exceeds `most` bytes, a file without any cells or without such a sheet, or with
/// several sheets of about as many rows.
pub(crate) fn to_text(bytes: &[u8], name: Option<&str>, most: u64) -> Result<String, String> {
    let text = |name: &str| {
        let found = member(bytes, name, 8 * most)?;
        Ok::<_, String>(found.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
    };
    let missing = |name: &str| format!("it has no {name}: save it again as .xlsx or as CSV");
    let workbook = "xl/workbook.xml";
    let workbook = text(workbook)?.ok_or_else(|| missing(workbook))?;
    let relations = text("xl/_rels/workbook.xml.rels")?.unwrap_or_default();
    let shared = text("xl/sharedStrings.xml")?.unwrap_or_default();
    let shared = shared_texts(&shared);
    let members = sheets(&workbook, &relations);
    let quoted = |names: &mut dyn Iterator<Item = &String>| {
        /// Most names in a message.
        const MOST: usize = 12;
        let mut names: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
        let more = names.len().saturating_sub(MOST);
        names.truncate(MOST);
        let rest = if more == 0 {
            String::new()
        } else {
            format!(" and {more} more")
        };
        names.join(", ") + &rest
    };
    let is_wanted = |other: &str| name.is_none_or(|name| name == other);
    let mut found: Vec<Sheet> = Vec::new();
    for (name, member) in members.iter().filter(|(name, _)| is_wanted(name)) {
        let Some(sheet) = text(member)? else { continue };
        found.push(Sheet {
            name: name.clone(),
            ..rows(&sheet, &shared, most)?
        });
    }
    if let (Some(name), true) = (name, found.is_empty()) {
        let names = quoted(&mut members.iter().map(|(name, _)| name));
        return Err(format!("it has no sheet \"{name}\"; there are {names}"));
    }
    let largest = found.iter().map(|sheet| sheet.rows).max().unwrap_or(0);
    let is_like_largest = |sheet: &&Sheet| 2 * sheet.rows > largest;
    let tables: Vec<&Sheet> = found.iter().filter(is_like_largest).collect();
    if let [first, _, ..] = tables[..] {
        return Err(format!(
            "it has {} sheets with tables, {}: name one of them after the file, as \"FILE.xlsx#{}\"",
            tables.len(),
            quoted(&mut tables.iter().map(|sheet| &sheet.name)),
            first.name
        ));
    }
    // Without values of its formulas a sheet may have no row of numbers.
    let formula = match tables.first() {
        Some(sheet) => &sheet.formula,
        None => &found.iter().find_map(|sheet| sheet.formula.clone()),
    };
    if let Some(cell) = formula {
        return Err(format!(
            "cell {cell} contains a formula and no value: open it in Excel or LibreOffice and save it again"
        ));
    }
    if let Some(row) = tables.first().and_then(|sheet| sheet.hidden) {
        return Err(format!(
            "row {row} is hidden: show the hidden rows, or delete them, and save it again"
        ));
    }
    let with_cells = || found.iter().find(|sheet| !sheet.table.trim().is_empty());
    match tables.first().copied().or_else(with_cells) {
        Some(sheet) => Ok(sheet.table.clone()),
        None => Err("no sheet has any cells".to_owned()),
    }
}

/// Number of rows of a table with two numbers.
fn rows_of_numbers(table: &str) -> usize {
    let is_number = |cell: &&str| cell.replacen(',', ".", 1).parse::<f64>().is_ok();
    let rows = table.lines();
    rows.filter(|row| row.split('\t').filter(is_number).nth(1).is_some())
        .count()
}

/// Names of the sheets in their order, each with the member of the archive that contains it.
fn sheets(workbook: &str, relations: &str) -> Vec<(String, String)> {
    let relations = parts(relations);
    let target = |id: &str| {
        relations.iter().find_map(|part| match part {
            Part::Start("Relationship", given) if attribute(given, "Id")? == id => {
                attribute(given, "Target")
            }
            _ => None,
        })
    };
    let workbook = parts(workbook);
    let sheets = workbook.iter().filter_map(|part| match part {
        Part::Start("sheet", given) => {
            let name = attribute(given, "name").unwrap_or_default();
            Some((name, target(&attribute(given, "id")?)?))
        }
        _ => None,
    });
    sheets
        .map(|(name, target)| match target.strip_prefix('/') {
            Some(whole) => (name, whole.to_owned()),
            None => (name, format!("xl/{target}")),
        })
        .collect()
}

/// Texts that cells refer to by their numbers.
fn shared_texts(document: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let (mut is_text, mut is_phonetic) = (false, false);
    for part in parts(document) {
        match part {
            Part::Start("si", _) => texts.push(String::new()),
            Part::Start("t", _) => is_text = true,
            Part::End("t") => is_text = false,
            Part::Start("rPh", _) => is_phonetic = true,
            Part::End("rPh") => is_phonetic = false,
            Part::Text(text) if is_text && !is_phonetic => {
                if let Some(last) = texts.last_mut() {
                    last.push_str(&text);
                }
            }
            _ => {}
        }
    }
    texts
}

/// Column of a cell, from 0, from its name: 27 for `AB12`.
fn column(name: &str) -> Option<usize> {
    let letters = name.bytes().take_while(u8::is_ascii_uppercase);
    let number = letters.fold(0_usize, |number, letter| {
        number
            .saturating_mul(26)
            .saturating_add(usize::from(letter - b'A') + 1)
    });
    number.checked_sub(1)
}

/// A sheet without its name.
fn rows(document: &str, shared: &[String], most: u64) -> Result<Sheet, String> {
    /// Columns of a sheet (ISO/IEC 29500, as Excel limits them).
    const MOST_COLUMNS: usize = 16_384;
    let too_large = || format!("the sheet has more than {} MB", most / 1_000_000);
    let mut text = String::new();
    let (mut lines, mut cells, mut kind) = (0_usize, 0_usize, String::new());
    // Files contain no empty cells at the ends of rows: a row is as long as the longest one before it.
    let mut longest = 0;
    let (mut value, mut is_value) = (String::new(), false);
    let (mut name, mut is_formula, mut formula) = (String::new(), false, None);
    let mut hidden = None;
    for part in parts(document) {
        match part {
            Part::Start("row", given) => {
                let number = attribute(given, "r").and_then(|number| number.parse().ok());
                let number: usize = number.unwrap_or(lines + 1);
                let is_hidden =
                    attribute(given, "hidden").is_some_and(|it| it == "1" || it == "true");
                if is_hidden {
                    hidden.get_or_insert(number);
                }
                let skipped = number.saturating_sub(lines + 1);
                if (text.len() + skipped) as u64 > most {
                    return Err(too_large());
                }
                text.push_str(&"\n".repeat(skipped));
                lines += skipped;
                cells = 0;
            }
            Part::Start("c", given) => {
                name = attribute(given, "r").unwrap_or_default();
                is_formula = false;
                let place = column(&name);
                let place = place.unwrap_or(cells).min(MOST_COLUMNS);
                while cells < place {
                    text.push('\t');
                    cells += 1;
                }
                kind = attribute(given, "t").unwrap_or_default();
                value.clear();
            }
            Part::Start("f", _) => is_formula = true,
            Part::Start("v" | "t", _) => is_value = true,
            Part::End("v" | "t") => is_value = false,
            Part::Text(part) if is_value => value.push_str(&part),
            Part::End("c") => {
                if is_formula && kind.is_empty() && value.trim().is_empty() {
                    formula.get_or_insert_with(|| name.clone());
                }
                let number = || value.trim().parse::<usize>().ok();
                let not_available = "n/a".to_owned();
                let shown = match &kind[..] {
                    "s" => number().and_then(|number| shared.get(number)),
                    // Errors of formulas, as #DIV/0!.
                    "e" => Some(&not_available),
                    _ => Some(&value),
                };
                let shown = shown.map_or("", |shown| shown.trim());
                text.push_str(&shown.replace(['\t', '\n', '\r'], " "));
                text.push('\t');
                cells += 1;
            }
            Part::End("row") => {
                text.truncate(text.trim_end_matches('\t').len());
                let row = &text[text.rfind('\n').map_or(0, |end| end + 1)..];
                if !row.is_empty() {
                    let tabs = row.matches('\t').count();
                    text.push_str(&"\t".repeat(longest.max(tabs) - tabs));
                    longest = longest.max(tabs);
                }
                text.push('\n');
                lines += 1;
            }
            _ => {}
        }
        if text.len() as u64 > most {
            return Err(too_large());
        }
    }
    Ok(Sheet {
        name: String::new(),
        rows: rows_of_numbers(&text),
        table: text,
        formula,
        hidden,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_a_sheet() {
        let shared = shared_texts(
            "<sst><si><t>Load</t></si><si><r><t>[</t></r><r><t>mN]</t></r></si></sst>",
        );
        assert_eq!(shared, ["Load", "[mN]"]);
        let sheet = "<sheetData><row r=\"2\"><c r=\"A2\" t=\"s\"><v>0</v></c><c r=\"C2\" t=\"inlineStr\"><is><t>z</t></is></c></row>\
                     <row><c><v>1.5</v></c><c/><c><v>2</v></c></row></sheetData>";
        let read = rows(sheet, &shared, 1000).map(|sheet| sheet.table);
        assert_eq!(read.as_deref(), Ok("\nLoad\t\tz\n1.5\t\t2\n"));
        // Rows end with their last cell that is not empty; the second one of 1/0.
        let sheet = "<row><c><v>a</v></c></row><row><c><v>x</v></c><c><v>y</v></c><c/></row><row><c><v>1</v></c></row>\
                     <row/><row><c t=\"e\"><f>1/0</f><v>#DIV/0!</v></c><c><v>2</v></c></row>";
        let read = rows(sheet, &shared, 1000).map(|sheet| sheet.table);
        assert_eq!(read.as_deref(), Ok("a\nx\ty\n1\t\n\nn/a\t2\n"));
        // A formula that no program has computed.
        let sheet = "<row><c r=\"A1\"><f>1+1</f><v>2</v></c><c r=\"B1\"><f>A1*2</f><v/></c></row>";
        let found = rows(sheet, &shared, 1000).unwrap();
        assert_eq!(found.formula.as_deref(), Some("B1"));
        // Rows that a filter hides.
        let sheet = "<row><c><v>1</v></c></row><row r=\"2\" hidden=\"1\"><c><v>2</v></c></row>";
        assert_eq!(rows(sheet, &shared, 1000).unwrap().hidden, Some(2));
        assert_eq!(column("AB12"), Some(27));
        assert_eq!(rows_of_numbers("x\ty\nnote\t1,5\t2\n"), 1);
        assert_eq!(rows_of_numbers("radius\t2\tmm\n3\n"), 0);
    }
}
