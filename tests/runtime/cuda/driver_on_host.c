/* As much of the driver as is called, in the memory of the host: kernels are loops over threads, code is a library. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int current; /* whether the context is: every call must see to it */

int cuInit(unsigned flags) { return (int)flags; }
int cuDeviceGetCount(int *n) { return *n = 1, 0; }
int cuDeviceGet(int *device, int k) { return *device = k, 0; }
int cuDeviceGetName(char *name, int size, int device) { return snprintf(name, (size_t)size, "host %d", device), 0; }
int cuDeviceGetAttribute(int *value, int which, int device) { return (void)device, *value = which == 75 ? 9 : 0, 0; }
int cuDevicePrimaryCtxRetain(void **context, int device) { return (void)device, *context = &current, 0; }
int cuCtxSetCurrent(void *context) { return current = context == &current, 0; }
int cuCtxSynchronize(void) { return current ? 0 : 201; }

/* Streams: what is asked of them is written down, and read by tests; 0x20 captures a graph. */
static char said[4096];
static int capturing, events;
static void say(const char *what, void *a, void *b) {
    size_t n = strlen(said);
    snprintf(said + n, sizeof said - n, "%s %lx %lx;", what, (unsigned long)a, (unsigned long)b);
}
const char *sym_said(void) { return said; }
void sym_forget(void) { said[0] = 0; }
void sym_capture(int on) { capturing = on; }
int sym_events(void) { return events; }
int cuStreamIsCapturing(void *stream, int *status) {
    *status = capturing && stream == (void *)0x20;
    return capturing == 2 && stream == (void *)1 ? 906 : 0; /* 2: from a stream that waits for the default one */
}
int cuStreamSynchronize(void *stream) {
    if (capturing) return 900;
    return say("wait", stream, NULL), current ? 0 : 201;
}
int cuEventCreate(void **event, unsigned flags) { return *event = malloc(1), events++, flags == 2 ? 0 : 1; }
int cuEventRecord(void *event, void *stream) { return *(char *)event = (char)(size_t)stream, 0; }
int cuStreamWaitEvent(void *stream, void *event, unsigned flags) {
    return say("order", (void *)(size_t) * (unsigned char *)event, stream), flags ? 1 : 0;
}
int cuEventDestroy_v2(void *event) { return free(event), events--, 0; }
int cuGetErrorString(int status, const char **text) { return (void)status, *text = "invalid argument", 0; }
int cuMemAlloc_v2(void **at, size_t size) {
    if (!current) return 201;
    if (capturing) return 900;
    return (*at = size > (size_t)1 << 40 ? NULL : malloc(size)) == NULL ? 2 : 0;
}
int cuMemFree_v2(void *at) { return free(at), 0; }
int cuMemcpyHtoD_v2(void *to, const void *from, size_t size) { return memcpy(to, from, size), 0; }
int cuMemcpyDtoH_v2(void *to, const void *from, size_t size) { return memcpy(to, from, size), 0; }
int cuModuleLoadData(void **module, const void *image) {
    return (*module = dlopen(image, RTLD_NOW | RTLD_LOCAL)) == NULL ? 200 : 0;
}
int cuModuleGetFunction(void **function, void *module, const char *name) {
    char launcher[256];
    snprintf(launcher, sizeof launcher, "%s_on_host", name);
    return (*function = dlsym(module, launcher)) == NULL ? 500 : 0;
}
int cuLaunchKernel(void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by, unsigned bz,
                   unsigned shared, void *stream, void **arguments, void **extra) {
    if (!current || gy * gz * by * bz != 1 || shared || extra || gx == 0 || bx > 1024) return 1;
    say("launch", stream, NULL);
    ((void (*)(unsigned, unsigned, void **))function)(gx, bx, arguments);
    return 0;
}
