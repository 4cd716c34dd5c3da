//! Reports, figures, and the proof of what they rest on.

#[path = "../common"]
mod common {
    pub mod assessment;
    pub mod campaign;
    pub mod certification;
    pub mod coach;
    pub mod document;
    pub mod program;
    pub mod tools;
    pub mod xml;
}

mod figures;
mod limits;
mod provenance;
mod report_html;
mod report_pdf;
mod report_view;
mod reports;
mod result_files;
