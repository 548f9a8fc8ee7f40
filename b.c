#include "t.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
__attribute__((noinline)) void f8(const double *q, double *o) { double x[8]={q[0],q[1],q[2],q[3],q[4],q[5],q[6],0},s[8],c[8]; blk8(x,s,c); for(int i=0;i<7;i++)o[2*i]=s[i],o[2*i+1]=c[i]; }
__attribute__((noinline)) void f4(const double *q, double *o) { double x[4]={q[0],q[1],q[2],q[3]},s[4],c[4]; blk4(x,s,c); for(int i=0;i<4;i++)o[2*i]=s[i],o[2*i+1]=c[i]; }
__attribute__((noinline)) void f2(const double *q, double *o) { double x[2]={q[0],q[1]},s[2],c[2]; blk2(x,s,c); for(int i=0;i<2;i++)o[2*i]=s[i],o[2*i+1]=c[i]; }
__attribute__((noinline)) void f1(const double *q, double *o) { one(q[0],o,o+1); if(!(fabs(q[0])<=1e5)) far_(1,q,o,o+1); }
__attribute__((noinline)) void g7(const double *q, double *o) { for(int i=0;i<7;i++)o[2*i]=sin(q[i]),o[2*i+1]=cos(q[i]); }
__attribute__((noinline)) void g1(const double *q, double *o) { o[0]=sin(q[0]),o[1]=cos(q[0]); }
static double now(void){struct timespec t;clock_gettime(CLOCK_MONOTONIC,&t);return t.tv_sec*1e9+t.tv_nsec;}
int main(){ static double q[16]; double o[64]; for(int i=0;i<16;i++)q[i]=rand()*6.0/RAND_MAX-3;
 struct{const char*n;void(*f)(const double*,double*);}F[]={{"f8",f8},{"f4",f4},{"f2",f2},{"f1",f1},{"g7",g7},{"g1",g1}};
 for(int r=0;r<3;r++)for(int j=0;j<6;j++){double best=1e9;for(int k=0;k<20;k++){double t=now();for(int i=0;i<20000;i++){F[j].f(q,o);q[i&7]+=1e-3;}t=(now()-t)/20000;if(t<best)best=t;}if(r==2)printf("%s %.1f ns\n",F[j].n,best);for(int i=0;i<16;i++)q[i]=rand()*6.0/RAND_MAX-3;}
}
