#include "effects/wetting_sheet.h"
#include <chrono>
#include <cstdio>
using namespace oilskin; using namespace oilskin::test;
static const double inf=INFINITY;
TEST(P,a){ for(int n:{50,100}) for(int k:{40,80}){ Fabric f; f.capacity=1; f.diffusivity=0.01; f.mobility_exponent=0; f.capillary_rise=inf;
 auto s=wetting_grid(n,1,1.0/n,1.0/n); s.make(f); s.hold_left(); double T=4; double m0=s.total(); for(int i=0;i<k;++i) s.step(T/k);
 double e=0; for(size_t i=0;i<s.x.size();++i) e=std::max(e,std::abs(s.saturation(i)-std::erfc(s.x[i].x()/(2*std::sqrt(.01*T)))));
 double up=s.supplied*n; printf("a n=%d k=%d err %g uptake/exact %g ledger %g\n",n,k,e,up/(2*std::sqrt(.01*T/M_PI)),(s.total()-m0-s.supplied)/s.total()); (void)m0; } }
TEST(P,b){ double c[]={1.61613,1.09032,0.87057},u[]={0.88750,0.75305,0.66517}; for(int a=1;a<=3;++a) for(int n:{60,120}) for (int k: {200,1000}){ Fabric f; f.capacity=1; f.diffusivity=1; f.mobility_exponent=a; f.capillary_rise=inf;
 auto s=wetting_grid(n,1,1.0/n,1.0/n); s.make(f); s.hold_left(); double T=std::pow(0.8/c[a-1],2); auto front=[&]{ for(int i=0;i<=n;++i) if(s.saturation(i)<0.01){ double p=s.saturation(i-1),q=s.saturation(i); return (i-1+(p-0.01)/(p-q))/n;} return 2.0;};
 double f1=0; for(int i=0;i<k;++i){ s.step(T/k); if(i+1==k/4) f1=front(); }
 double f2=front(); printf("b a=%d n=%d k=%d front/exact %g slope %g uptake %g\n",a,n,k,f2/0.8,std::log(f2/f1)/std::log(4.0),s.supplied*n/(u[a-1]*std::sqrt(T))); } }
TEST(P,c){ for(double an:{1.,4.,9.}) for(double ang:{0.,30.}) for(double jit:{0.,.35}) for (int k:{40}) { int n=40; Fabric f; f.capacity=1; f.diffusivity=1; f.mobility_exponent=0; f.capillary_rise=inf; f.anisotropy=an; f.warp=Vec3(std::cos(ang*M_PI/180),std::sin(ang*M_PI/180),0);
 auto s=wetting_grid(n,n,1.0/n,1.0/n); jitter(s,1.0/n,jit,3); s.make(f); size_t mid=(n/2)*(n+1)+n/2; s.set_saturation(mid,1); double T=0.003; double lo=0,hi=0; for(int i=0;i<k;++i){ s.step(T/k); for(size_t j=0;j<s.x.size();++j){lo=std::min(lo,s.saturation(j));hi=std::max(hi,s.saturation(j));} }
 Eigen::Rotation2Dd R(ang*M_PI/180); Eigen::Matrix2d M=R.inverse()*spread(s)*R.toRotationMatrix(); double kw=2*an/(1+an),kf=2/(1+an);
 printf("c an=%g ang=%g jit=%g warp %g weft %g cross %g lo %g neg %d\n",an,ang,jit,M(0,0)/(2*kw*T),M(1,1)/(2*kf*T),M(0,1)/(2*T),lo,(int)0); } }
TEST(P,d){ for(int a=1;a<=3;++a){ int n=80; Fabric f; f.capacity=1; f.diffusivity=1; f.mobility_exponent=a; f.capillary_rise=inf; auto s=wetting_grid(n,n,2.0/n,2.0/n); s.make(f);
 for(size_t i=0;i<s.x.size();++i){ double r2=(s.x[i]-Vec3(1,1,0)).squaredNorm(); if(r2<0.2*0.2) s.set_saturation(i,std::pow(1-r2/0.04,1.0/a)); }
 // start = Barenblatt profile: R0=.2
 double q=2*a+2; // R^q = R0^q + ...; t0 from S0=1: 
 double t0=0.04*a/(2*q)/1.0; // S=(1-r2/R2)^{1/a} t^-..., R^2 a/(2q t)=S_max^a
 double t=t0; double tl=0,rl=0; auto area=[&]{double A=0; auto sp=spread(s); A=std::sqrt(sp.trace()); return A;};
 double r0=area(); int cnt=0; double dt=t0/20; while(t<t0*200){ s.step(dt); t+=dt; dt=std::min(dt*1.02,t/20); if(tl==0&&t>t0*5){tl=t; rl=area();} ++cnt; }
 printf("d a=%d exponent %g exact %g  from start %g steps %d  R %g\n",a,std::log(area()/rl)/std::log(t/tl),1/q,std::log(area()/r0)/std::log(t/t0),cnt,0.2*std::pow(t/t0,1/q)); } }
TEST(P,e){ for(double a:{1.,2.}) for(int n:{10,20,40}) for (double dt:{1.,100.,1e4}) { Fabric f; f.capacity=.3; f.diffusivity=1e-5; f.mobility_exponent=a; f.capillary_rise=.1; double w=.1/n; auto s=wetting_grid(2*n,1,w,w); s.make(f); s.hold_left();
 double T = 4e4; int k=std::max(100,(int)(T/dt)); if(dt<2) k=8000; for(int i=0;i<k;++i) s.step(dt,Vec3(-9.81,0,0)); double e=0,top=0; for(size_t i=0;i<s.x.size();++i){ double z=s.x[i].x()/.1; e=std::max(e,std::abs(s.saturation(i)-std::max(0.,1-z))); if(s.saturation(i)>.01) top=std::max(top,z); }
 printf("e a=%g n=%d dt=%g err %g top %g\n",a,n,dt,e,top); } }
