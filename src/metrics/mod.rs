//! stub
pub mod filter { #[derive(Clone,Copy,Debug,PartialEq)] pub enum Band{LowPass(f64),HighPass(f64),BandPass(f64,f64),BandStop(f64,f64)}
 #[derive(Clone,Copy,Debug,PartialEq)] pub enum Phase{Zero,Causal,CausalFromRest} #[derive(Clone,Copy,Debug,PartialEq)] pub enum Cutoff{AsApplied,PerPass} }
pub mod window { #[derive(Clone,Copy,Debug,PartialEq)] pub enum Ends{Samples,Integral} }
pub mod percentile { #[derive(Clone,Copy,Debug,PartialEq)] pub enum Method{Linear} impl Method{ pub fn from_name(_:&str)->Option<Self>{Some(Self::Linear)} pub fn names()->impl Iterator<Item=&'static str>{["linear"].into_iter()} } pub fn percentile(_:&[f64],_:f64,_:Method)->Option<f64>{None} }
pub mod statistics { pub struct L{pub slope:f64} 
pub fn median(_:&[f64])->Option<f64>{None} pub fn mean(_:&[f64])->Option<f64>{None} pub fn rms(_:&[f64])->Option<f64>{None} pub fn minimum(_:&[f64])->Option<f64>{None} pub fn maximum(_:&[f64])->Option<f64>{None} pub fn peak(_:&[f64])->Option<f64>{None} pub fn range(_:&[f64])->Option<f64>{None}
pub fn standard_deviation(_:&[f64],_:usize)->Option<f64>{None} pub fn regression(_:&[f64],_:&[f64])->Option<L>{None} pub fn mean_interval(_:&[f64],_:f64)->Option<(f64,f64)>{None} pub fn std_interval(_:&[f64],_:f64)->Option<(f64,f64)>{None} }
pub mod pair { macro_rules! f {($($n:ident)*)=>{$(pub fn $n(_:&[f64],_:&[f64])->Result<f64,String>{Ok(0.0)})*}} f!(sprague_geers_magnitude sprague_geers_phase sprague_geers_comprehensive russell_magnitude russell_phase russell_comprehensive theil_u1 wifac correlation misfit_squared bogojevic rmse area); }
pub mod hysteresis { pub struct MatchingError{pub maximum:f64,pub mean:f64} pub fn matching_error(_:&[f64],_:&[f64],_:&[f64],_:&[f64])->Result<MatchingError,String>{Err(String::new())} }
