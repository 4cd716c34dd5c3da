use std::path::{Path,PathBuf};
pub fn write_whole(p:&Path,b:&[u8])->std::io::Result<()>{ if let Some(d)=p.parent(){std::fs::create_dir_all(d)?;} std::fs::write(p,b)}
pub fn write_all(o:&Path,f:&[(PathBuf,Vec<u8>)])->std::io::Result<()>{for(p,b) in f{write_whole(&o.join(p),b)?;}Ok(())}
