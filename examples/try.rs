use fishplate::{source::Source, problem::Problems, check};
fn main(){ let p=std::env::args().nth(1).unwrap(); let s=Source::new(p.clone(), std::fs::read_to_string(&p).unwrap()); let mut pr=Problems::default();
 let f=check::family::read(&s,&|n,_|{ let p=format!("protocols/{n}.fp"); Ok(Source::new(p.clone(), std::fs::read_to_string(&p).unwrap())) },&mut pr);
 let plan=check::check(&f,&Default::default(),&mut pr); print!("{}",pr.render(false));
 if let Some(plan)=plan { let g=fishplate::graph::from_plan(&plan); if std::env::args().nth(2).is_some(){print!("{}",fishplate::graph::text(&g));} println!("{} nodes",g.nodes.len()); std::fs::write("/tmp/g.svg",fishplate::graph::svg(&g)).unwrap();
  for q in &plan.quantities { println!("{} | {} | {} | {} | {} ", q.id,q.words.of,q.words.filter,q.words.processing,q.words.comparison);} }
}
