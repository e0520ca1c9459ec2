use fakir::contact::*;
use fakir::love::ElementMesh;
use fakir::system::*;
struct Rng(u64);
impl Rng { fn u(&mut self)->f64{ self.0=self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((self.0>>11) as f64)/((1u64<<53) as f64)} fn lin(&mut self,a:f64,b:f64)->f64{a+(b-a)*self.u()} fn log(&mut self,a:f64,b:f64)->f64{(self.lin(a.ln(),b.ln())).exp()} }
fn main(){
 let args:Vec<String>=std::env::args().collect();
 let n:usize=args[1].parse().unwrap(); let seed:u64=args[2].parse().unwrap(); let love:usize=args.get(3).map_or(0,|s|s.parse().unwrap());
 let mut r=Rng(seed.wrapping_mul(7919)+12345); for _ in 0..9{r.u();}
 let run=Run{memory_limit:Some(1_000_000_000),..Run::default()};
 let mut done=0;
 while done<n {
  let d=6e-6; let rd=r.log(4.0,3000.0); let hd=r.log(0.01,3.0); let er=r.log(1e-3,1e3); let phi=r.log(1e-3,0.5); let off=r.lin(0.,0.6); let ang=r.lin(0.,std::f64::consts::TAU); let col=r.u()<0.6;
  let crit=r.u()<0.5; let frac=r.log(0.05,1.2);
  let h=hd*d; if h>=rd*d {continue;}
  let mk=|off:f64,ang:f64|{
   let pillar=Pillar{diameter:d,height:h,compliance:if col{PillarCompliance::Column}else{PillarCompliance::None}};
   let lattice=HexagonalLattice::with_surface_fraction(phi,d).offset_by(off);
   let lattice=HexagonalLattice{offset_angle:ang,..lattice};
   System::new(Lens{radius:rd*d,material:Material::new(2e6,0.5)},Material::new(2e6*er,0.5),Texture{pillar,lattice})};
  let Ok(sys)=mk(off,ang) else {continue};
  // rough size limit
  let Ok(c)=fakir::transition(&sys,Method::Punch(PunchForm::Corrected),&run) else {continue};
  if c.regime==Regime::BottomFirst || c.contact.pillars_in_contact>400 || !c.contact.converged() {continue;}
  let zeta=c.contact.indentation*frac;
  let go=|s:&System,m:Method|->Option<(f64,f64,usize,usize,f64)>{
    let st= if crit { fakir::transition(s,m,&run).ok()?.contact } else { fakir::press(s,Load::Indentation(zeta),m,&run).ok()? };
    if !st.converged(){return None;}
    Some((st.contact_radius,st.contact_radius_error,st.pillars_in_contact,st.pillars_partially_in_contact,st.force))};
  let Some(a)=go(&sys,Method::Spectral(Accuracy::Default)) else {continue};
  if a.4<=0.0 {continue;}
  done+=1;
  let mut show=|name:&str,b:Option<(f64,f64,usize,usize,f64)>|{ if let Some(b)=b { let e=(a.0-b.0).abs(); let s=a.1+b.1; println!("{name} ratio {:.4} diff/a {:.4} rel {:.2e} est/a {:.4} {:.4} r/a {:.3} {:.3} pillars {} {} partial {} {} | rd {:.1} hd {:.3} er {:.2e} phi {:.4} off {:.3} ang {:.3} col {} crit {} frac {:.3}",e/s,e/(0.5*d),e/b.0,a.1/(0.5*d),b.1/(0.5*d),a.0/(0.5*d),b.0/(0.5*d),a.2,b.2,a.3,b.3,rd,hd,er,phi,off,ang,col,crit,frac);} };
  show("accurate",go(&sys,Method::Spectral(Accuracy::Accurate)));
  let sys2=mk(off,ang+std::f64::consts::FRAC_PI_3).unwrap();
  show("turned",go(&sys2,Method::default()));
  let sys3=mk(off,-ang).unwrap();
  show("mirror",go(&sys3,Method::default()));
  show("punch",go(&sys,Method::Punch(PunchForm::Corrected)));
  show("plain",go(&sys,Method::Punch(PunchForm::Plain)));
  show("homog",go(&sys,Method::Homogenised));
  if love>0 && a.2<80 { show("love",go(&sys,Method::Love(ElementMesh{cells_per_diameter:love,..ElementMesh::default()}))); }
 }
}
