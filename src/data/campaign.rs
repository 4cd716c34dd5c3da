use std::path::{Path,PathBuf}; use crate::problem::*; use crate::source::*; use crate::yaml::Node; use crate::result::*; use crate::syntax::document::Text; use super::table::Table;
#[derive(Clone,Copy,Debug,PartialEq,Eq)] pub enum RecordKind{Measurement,Simulation,Track}
impl RecordKind{ pub fn in_words(self)->&'static str{match self{Self::Measurement=>"measurement",Self::Simulation=>"simulation",Self::Track=>"track"}}}
#[derive(Debug)] pub struct Campaign{ pub folder:PathBuf, pub name:String, pub facts:Vec<DataItem>, pub parameters:Vec<(String,Text)>, pub protocol:Option<(String,Span)>, pub vehicle:Node, pub sections:Option<Table>, pub files:Vec<FileHash>}
impl Campaign{ pub fn open(folder:&Path, problems:&mut Problems)->Option<Self>{ let s=Source::new("campaign.yaml",std::fs::read_to_string(folder.join("campaign.yaml")).ok()?); let c=crate::yaml::load(&s,problems)?; let v=Source::new("vehicle.yaml",std::fs::read_to_string(folder.join("vehicle.yaml")).ok()?);
 Some(Self{folder:folder.into(),name:c.get("name")?.raw.clone(),facts:vec![],parameters:vec![],protocol:None,vehicle:crate::yaml::load(&v,problems)?,sections: if c.get("sections").is_some(){Table::read(&folder.join("sections.csv"),"sections.csv","section",problems)}else{None},files:vec![]})}
 pub fn record(&self,k:RecordKind,s:&str)->Option<PathBuf>{Some(self.folder.join(k.in_words()).join(format!("{s}.csv")))}
 pub fn shown(&self,p:&Path)->String{p.strip_prefix(&self.folder).unwrap_or(p).display().to_string()}
 pub fn record_names(&self)->Vec<String>{let mut v:Vec<String>=std::fs::read_dir(self.folder.join("measurement")).map(|d|d.flatten().map(|e|e.path().file_stem().unwrap().to_string_lossy().into_owned()).collect()).unwrap_or_default();v.sort();v}}
