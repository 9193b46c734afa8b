/* Sulcus for programs of any language: a scene is opened, stepped with a pose to a wrench, and what
 * it did is asked for. One header, C11, of libsulcus; link with -lsulcus.
 *
 * Units: SI. A pose is 7 numbers: x, y, z of the burr's tip in the world, then the orientation (w,
 * x, y, z), world from tool, of length 1. A wrench is 6: force, then torque about the burr's
 * reference point, both on the hand, in world axes. World: the scene's, its origin the centre of
 * the tooth's grid, +z up. Tool: +y is the burr's axis, from tip to shank.
 *
 * Errors: functions return SULCUS_DONE or what was wrong (sulcus_error_text says it in words), and
 * what they were to fill in is then as it was. Where a file or text may be at fault, one line of
 * text says what, in the caller's `error` of `error_size` bytes; both may be 0. No exception, no
 * signal, no message on the terminal.
 *
 * Threads: a handle is used by one thread at a time, which may change from call to call; a second
 * one that comes meanwhile gets SULCUS_BUSY, at once. Different handles know nothing of each other:
 * there are no globals. Opening uses all cores for a while.
 *
 * Time: sulcus_step neither waits, locks, reads a clock nor takes memory, but in a scene with
 * [loose_pieces], where every tenth step looks for pieces. Everything is sized when a scene opens.
 * A step is 1 / rate_hz seconds of the scene, however long it takes.
 *
 * Results: same scene, same poses: the same bits, on x86-64 whatever the processor and system; on
 * AArch64 the same voxels.
 *
 * Life: sulcus_close gives a run's memory back; the handle then answers SULCUS_CLOSED to
 * everything. sulcus_free takes the handle itself away and sets it to NULL. One that is NULL gets
 * SULCUS_NULL. (A copy of a handle that was freed is as any freed pointer.)
 *
 * Versions: functions, codes and structures stay, but those with a `struct_size`, which grow at
 * their ends: the caller sets it to what sizeof says to it.
 *
 * Licence: MIT, as the rest. */
#ifndef SULCUS_H
#define SULCUS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) && defined(SULCUS_BUILDS_DLL)
#define SULCUS_API __declspec(dllexport)
#elif defined(_WIN32) && !defined(SULCUS_STATIC)
#define SULCUS_API __declspec(dllimport)
#elif defined(__GNUC__)
#define SULCUS_API __attribute__((visibility("default")))
#else
#define SULCUS_API
#endif

/* Rises when a program made for an older one would no longer run. */
#define SULCUS_VERSION 1u

/* What functions return. */
enum {
  SULCUS_DONE = 0,
  SULCUS_NULL = 1,      /* a pointer that has to be there is NULL */
  SULCUS_CLOSED = 2,    /* the handle was closed */
  SULCUS_BUSY = 3,      /* another thread is using the handle */
  SULCUS_BAD_VALUE = 4, /* a number not finite, out of range, or an orientation not of length 1 */
  SULCUS_BAD_INPUT = 5, /* a scene, a file or a saved state that cannot be used: see `error` */
  SULCUS_TOO_SMALL = 6, /* no room for what was asked: the size that is needed was set */
  SULCUS_NO_DEVICE = 7, /* the scene's device is not one that is simulated or follows a path */
  SULCUS_LOST = 8,      /* edits that far back are no longer kept: take the volume instead */
  SULCUS_ENDED = 9, /* a force was not finite and the run has ended; a restore begins it again */
  SULCUS_UNSUPPORTED = 10, /* not in a scene like this, or not on this system: see the function */
  SULCUS_FAILED = 11       /* out of memory, or an error of ours: close the handle */
};

typedef struct SulcusSimulation SulcusSimulation;
typedef struct SulcusSurface SulcusSurface;

/* What a run begins with. */
typedef struct SulcusSource {
  size_t struct_size;
  const char* file; /* a scene; with `text` what messages call it and relative paths start from */
  const char* text; /* TOML; NULL: what is in `file` */
  /* KEY=VALUE as of `sulcus run --set`, so many of them; may be NULL. */
  const char* const* overrides;
  size_t override_count;
  /* Voxels instead of the scene's workpiece, whose grid they have; NULL: the scene's. One byte
   * each, x fastest, then y, then z: 0 empty, else 1 + the number of its tissue in the scene. */
  const uint8_t* voxels;
  size_t voxel_count;
} SulcusSource;

typedef struct SulcusGrid {
  int32_t cells[3];
  double voxel_m;
  double origin_m[3]; /* of the centre of voxel (0, 0, 0), world */
} SulcusGrid;

/* What the last step did. `struct_size` is set by the caller. */
typedef struct SulcusTick {
  size_t struct_size;
  uint64_t tick; /* its number, from 0 */
  double time_s;
  double device_pose[7];    /* as it was read */
  double tool_pose[7];      /* where the tool is: behind a coupling not the same */
  double wrench[6];         /* sent to the hand */
  double contact_wrench[6]; /* of the contact, before limits and coupling */
  double spindle_rad_per_s; /* during the step */
  uint32_t contacts;        /* voxels that take part in the force */
  uint32_t removed;         /* voxels cut of the workpiece */
  uint32_t faults;          /* bits, as in recordings (`sulcus help recording`) */
  uint32_t evaluations;     /* of the contact */
} SulcusTick;

/* A voxel in contact. */
typedef struct SulcusContact {
  double position_m[3]; /* centre of the voxel, world */
  float normal[3];      /* unit, out of the tooth, world; zero: none was found */
  float depth_m;        /* of the surface there inside the burr */
  float force_N;        /* along the normal, after scaling */
  uint32_t voxel;       /* x + y nx + z nx ny, of its body's grid */
  uint16_t body;        /* 0: the workpiece, then the scene's others */
  uint8_t tissue;       /* its number in the scene */
  uint8_t reserved;
} SulcusContact;

/* A voxel that changed. */
typedef struct SulcusEdit {
  uint64_t tick;
  uint32_t voxel; /* x + y nx + z nx ny, of its body's grid */
  uint16_t body;
  uint8_t cause; /* 0 cut, 1 loose */
  uint8_t level; /* 0: it is gone; else what is left of it, in parts of 255 */
} SulcusEdit;

typedef struct SulcusVertex {
  float position_m[3];   /* world */
  int16_t normal[4];     /* outward unit normal times 32767; the fourth is 0 */
  uint8_t colour_cut[4]; /* square roots of linear RGB times 255; how much of it was cut */
} SulcusVertex;

/* A part of a surface, to be drawn instead of what it was before. */
typedef struct SulcusBrick {
  int32_t number; /* from 0, the same part always; -1: no more have changed */
  uint32_t vertex_count, index_count;
  const SulcusVertex* vertices; /* until the next call with this surface */
  const uint32_t* indices;      /* three a triangle, counter-clockwise seen from outside */
} SulcusBrick;

/* Of the library: its release, "0.1.0"; SULCUS_VERSION as it was built; a code in words, never
 * NULL. Any thread. */
SULCUS_API const char* sulcus_release(void);
SULCUS_API uint32_t sulcus_version(void);
SULCUS_API const char* sulcus_error_text(int code);

/* Opens a scene; seconds for a large tooth. BAD_INPUT: `error` says file, place, found, expected. A
 * scene whose trajectory is a recording's is refused. Where the library was built without import
 * (Windows), so are files of volumes and meshes. */
SULCUS_API int sulcus_open(const SulcusSource* source, SulcusSimulation** simulation, char* error,
                           size_t error_size);
/* The same of a file alone. */
SULCUS_API int sulcus_open_file(const char* file, SulcusSimulation** simulation, char* error,
                                size_t error_size);
SULCUS_API int sulcus_close(SulcusSimulation* simulation);
/* Closes it where it is not; a NULL handle is done with. Not while another call uses it: BUSY. */
SULCUS_API int sulcus_free(SulcusSimulation** simulation);

/* One tick: the hand's pose in, the wrench for it out; `wrench` may be NULL. A pose with a number
 * not finite, beyond 10 m, or an orientation whose length is not 1 within 1e-3 is BAD_VALUE, and
 * nothing happened; one within it is brought to length 1, one within 1e-12 is used as it is. */
SULCUS_API int sulcus_step(SulcusSimulation* simulation, const double pose[7], double wrench[6]);
/* The same with the scene's own device: the path, exactly, or the simulated device and hand.
 * NO_DEVICE where it is a plug-in. */
SULCUS_API int sulcus_step_scene(SulcusSimulation* simulation, double wrench[6]);
/* Steps that the scene's trajectory has. */
SULCUS_API int sulcus_scene_ticks(const SulcusSimulation* simulation, uint64_t* ticks);
/* Where that has the tip at a time: tick n is at n * (1.0 / rate_hz). */
SULCUS_API int sulcus_scene_pose(const SulcusSimulation* simulation, double time_s, double pose[7]);
SULCUS_API int sulcus_rate_hz(const SulcusSimulation* simulation, double* rate_hz);

/* BAD_VALUE before the first step. After sulcus_restore, until the next step, tick, faults and tool
 * are those of the save; the rest is zero, and there are no contacts. */
SULCUS_API int sulcus_last_tick(const SulcusSimulation* simulation, SulcusTick* tick);
/* The contacts of the last tick, of all bodies. `count`: how many there are; TOO_SMALL, and no
 * contact written, where that is more than `capacity`. */
SULCUS_API int sulcus_contacts(const SulcusSimulation* simulation, SulcusContact* contacts,
                               size_t capacity, size_t* count);
/* Edits from number `from` on, 0 the run's first, up to `capacity` of them; `count`: how many these
 * are. The last 262144 are kept. To go on, ask from `from` + `count`. */
SULCUS_API int sulcus_edits(const SulcusSimulation* simulation, uint64_t from, SulcusEdit* edits,
                            size_t capacity, size_t* count);
/* Edits so far. */
SULCUS_API int sulcus_edit_count(const SulcusSimulation* simulation, uint64_t* count);

/* Of body 0, the workpiece, and those beside it. BAD_VALUE beyond the last. */
SULCUS_API int sulcus_grid(const SulcusSimulation* simulation, uint32_t body, SulcusGrid* grid);
/* Its solid voxels as they are, 8 a byte, the lowest bit first, x fastest, then y, then z.
 * `needed`: the bytes that takes, cells / 8; TOO_SMALL where `size` is less. */
SULCUS_API int sulcus_volume(const SulcusSimulation* simulation, uint32_t body, uint8_t* bits,
                             size_t size, size_t* needed);
SULCUS_API int sulcus_solid_voxels(const SulcusSimulation* simulation, uint64_t* voxels);

/* `volume_hash` and `force_hash` of a summary, as numbers ("%016llx" is their text there), and the
 * hash of all else that a later tick depends on. */
SULCUS_API int sulcus_volume_hash(const SulcusSimulation* simulation, uint64_t* hash);
SULCUS_API int sulcus_force_hash(const SulcusSimulation* simulation, uint64_t* hash);
SULCUS_API int sulcus_state_hash(const SulcusSimulation* simulation, uint64_t* hash);

/* All of a run as it is, for the same scene and the same library. `needed`: its bytes; TOO_SMALL
 * where `size` is less. Not with [loose_pieces]: UNSUPPORTED. */
SULCUS_API int sulcus_save(SulcusSimulation* simulation, void* bytes, size_t size, size_t* needed);
/* A tick after it gives the same bits as one after the save. BAD_INPUT: bytes of another scene, of
 * one whose files held something else, or damaged ones; nothing was changed. Numbers of edits go on
 * from those of the save; those before it are LOST. */
SULCUS_API int sulcus_restore(SulcusSimulation* simulation, const void* bytes, size_t size,
                              char* error, size_t error_size);

/* A surface for a renderer of one's own: a copy of the workpiece as it is now, brought up to date
 * by the edits that are given to it. A handle of its own, for a thread of its own. */
SULCUS_API int sulcus_surface_open(const SulcusSimulation* simulation, SulcusSurface** surface);
/* Edits as sulcus_edits gives them, each once, in their order; those of other bodies are skipped.
 */
SULCUS_API int sulcus_surface_apply(SulcusSurface* surface, const SulcusEdit* edits, size_t count);
/* Meshes the next brick that changed, at first each of them. */
SULCUS_API int sulcus_surface_next(SulcusSurface* surface, SulcusBrick* brick);
SULCUS_API int sulcus_surface_free(SulcusSurface** surface);

#ifdef __cplusplus
}
#endif

#endif
