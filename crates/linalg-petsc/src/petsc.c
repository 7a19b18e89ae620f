/* What Stoss needs of MPI and PETSc, in plain C types: handles, widths of integers and constants are those of the headers. Functions return 0, or the code of an error, whose text sp_error has. */
#include <petscksp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(call) do { PetscErrorCode code_ = (call); if (code_) return (int)code_; } while (0)
#define ENGINES 2

static char error_text[1024];

/* Keeps the text of the place where an error began; the codes go up to the caller. */
static PetscErrorCode keep_error(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code, PetscErrorType type, const char *message, void *context) {
  (void)comm; (void)line; (void)file; (void)context;
  if (type == PETSC_ERROR_INITIAL) snprintf(error_text, sizeof error_text, "%s: %s", function ? function : "PETSc", message ? message : "");
  return code;
}

static int own_error(const char *text) {
  snprintf(error_text, sizeof error_text, "%s", text);
  return PETSC_ERR_LIB;
}

const char *sp_error(void) { return error_text; }

int sp_start(void) {
  if (sizeof(double) != sizeof(PetscScalar)) return own_error("PETSc must be built for real numbers of double precision");
  /* Calls come from one thread at a time, not always from the same one. */
  PETSC_MPI_THREAD_REQUIRED = MPI_THREAD_SERIALIZED;
  /* Signals are the program's matter. */
  CHECK(PetscOptionsSetValue(NULL, "-no_signal_handler", "true"));
  CHECK(PetscInitializeNoArguments());
  CHECK(PetscPushErrorHandler(keep_error, NULL));
  MPI_Comm_set_errhandler(PETSC_COMM_WORLD, MPI_ERRORS_ARE_FATAL);
  return 0;
}
int sp_end(void) { CHECK(PetscFinalize()); return 0; }
int sp_rank(void) { int rank = 0; MPI_Comm_rank(PETSC_COMM_WORLD, &rank); return rank; }
int sp_size(void) { int size = 1; MPI_Comm_size(PETSC_COMM_WORLD, &size); return size; }
void sp_abort(int code) { MPI_Abort(MPI_COMM_WORLD, code); }

/* The address of an empty slice of Rust may be 1, which is MPI_IN_PLACE of Open MPI. */
static double nothing;
#define OR_NOTHING(pointer, count) ((count) > 0 ? (void *)(pointer) : (void *)&nothing)

int sp_gather(const double *mine, int count, double *all, const int *counts, const int *starts) {
  return MPI_Allgatherv(OR_NOTHING(mine, count), count, MPI_DOUBLE, all, counts, starts, MPI_DOUBLE, PETSC_COMM_WORLD);
}
int sp_gather_bytes(const unsigned char *mine, int count, unsigned char *all, const int *counts, const int *starts) {
  int total = starts[sp_size() - 1] + counts[sp_size() - 1];
  return MPI_Allgatherv(OR_NOTHING(mine, count), count, MPI_BYTE, OR_NOTHING(all, total), counts, starts, MPI_BYTE, PETSC_COMM_WORLD);
}
int sp_gather_int(int mine, int *all) { return MPI_Allgather(&mine, 1, MPI_INT, all, 1, MPI_INT, PETSC_COMM_WORLD); }

/* Only ranks that have something to say to each other do; both sides know. What a rank sends to itself is copied. */
int sp_exchange(const double *send, const int *send_counts, double *receive, const int *receive_counts) {
  int size = sp_size(), me = sp_rank(), n = 0, code = MPI_SUCCESS;
  size_t at = 0, to = 0, own_at = 0, own_to = 0;
  MPI_Request *requests = malloc(2 * (size_t)size * sizeof *requests);
  if (!requests) return MPI_ERR_NO_MEM;
  for (int r = 0; r < size && !code; r++) {
    if (r == me) own_at = at;
    else if (receive_counts[r] > 0) code = MPI_Irecv(receive + at, receive_counts[r], MPI_DOUBLE, r, 7, PETSC_COMM_WORLD, &requests[n++]);
    at += (size_t)receive_counts[r];
  }
  for (int r = 0; r < size && !code; r++) {
    if (r == me) own_to = to;
    else if (send_counts[r] > 0) code = MPI_Isend(send + to, send_counts[r], MPI_DOUBLE, r, 7, PETSC_COMM_WORLD, &requests[n++]);
    to += (size_t)send_counts[r];
  }
  if (send_counts[me] > 0) memcpy(receive + own_at, send + own_to, (size_t)send_counts[me] * sizeof(double));
  if (!code) code = MPI_Waitall(n, requests, MPI_STATUSES_IGNORE);
  free(requests);
  return code;
}

int sp_options(const char *text) { CHECK(PetscOptionsInsertString(NULL, text)); return 0; }

/* Names of the options with this prefix that PETSc has not asked for, each followed by a space, as far as they fit. */
int sp_unused(const char *prefix, char *text, size_t length) {
  PetscInt count;
  char **names, **values;
  size_t used = 0;
  CHECK(PetscOptionsLeftGet(NULL, &count, &names, &values));
  text[0] = 0;
  for (PetscInt k = 0; k < count; k++) {
    size_t n = strlen(names[k]);
    if (strncmp(names[k], prefix, strlen(prefix)) != 0 || used + n + 2 > length) continue;
    memcpy(text + used, names[k], n);
    used += n;
    text[used++] = ' ';
    text[used] = 0;
  }
  CHECK(PetscOptionsLeftRestore(NULL, &count, &names, &values));
  return 0;
}

/* A matrix with its vectors, and up to ENGINES solvers of it. */
typedef struct { Mat a; Vec b, x, r; KSP ksp[ENGINES]; PetscInt rows; } System;

int sp_destroy(System *s) {
  for (int e = 0; e < ENGINES; e++) CHECK(KSPDestroy(&s->ksp[e]));
  CHECK(VecDestroy(&s->b)); CHECK(VecDestroy(&s->x)); CHECK(VecDestroy(&s->r)); CHECK(MatDestroy(&s->a));
  free(s);
  return 0;
}

/* Gives the matrix `count` motions, `rows` numbers each, as those that cost no energy, orthonormalised. */
static int near_null_space(System *s, int count, const double *motions) {
  Vec modes[6];
  MatNullSpace space;
  int kept = 0;
  if (count > 6) return own_error("more than six rigid motions");
  for (int k = 0; k < count; k++) {
    PetscScalar *values;
    PetscReal before, after;
    CHECK(VecDuplicate(s->x, &modes[kept]));
    CHECK(VecGetArray(modes[kept], &values));
    memcpy(values, motions + (size_t)k * (size_t)s->rows, (size_t)s->rows * sizeof(double));
    CHECK(VecRestoreArray(modes[kept], &values));
    CHECK(VecNorm(modes[kept], NORM_2, &before));
    for (int l = 0; l < kept; l++) { PetscScalar dot; CHECK(VecDot(modes[kept], modes[l], &dot)); CHECK(VecAXPY(modes[kept], -dot, modes[l])); }
    CHECK(VecNormalize(modes[kept], &after));
    /* Nodes on a line do not turn about it. */
    if (after > 1e-10 * before) kept++; else CHECK(VecDestroy(&modes[kept]));
  }
  CHECK(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, kept, modes, &space));
  CHECK(MatSetNearNullSpace(s->a, space));
  CHECK(MatNullSpaceDestroy(&space));
  for (int k = 0; k < kept; k++) CHECK(VecDestroy(&modes[k]));
  return 0;
}

static int create(System *s, int block, ptrdiff_t entries, int *i, int *j, int symmetric, int motions, const double *values) {
  CHECK(MatCreate(PETSC_COMM_WORLD, &s->a));
  CHECK(MatSetSizes(s->a, s->rows, s->rows, PETSC_DETERMINE, PETSC_DETERMINE));
  CHECK(MatSetBlockSize(s->a, block));
  CHECK(MatSetType(s->a, MATAIJ));
  if (sizeof(PetscInt) == sizeof(int)) {
    CHECK(MatSetPreallocationCOO(s->a, entries, (PetscInt *)i, (PetscInt *)j));
  } else {
    PetscInt *wide = malloc((2 * (size_t)entries + 1) * sizeof *wide);
    if (!wide) return own_error("no memory for the places of the entries");
    for (ptrdiff_t k = 0; k < entries; k++) { wide[k] = i[k]; wide[entries + k] = j[k]; }
    PetscErrorCode code = MatSetPreallocationCOO(s->a, entries, wide, wide + entries);
    free(wide);
    CHECK(code);
  }
  if (symmetric) { CHECK(MatSetOption(s->a, MAT_SYMMETRIC, PETSC_TRUE)); CHECK(MatSetOption(s->a, MAT_SYMMETRY_ETERNAL, PETSC_TRUE)); }
  CHECK(MatCreateVecs(s->a, &s->x, &s->b));
  CHECK(VecDuplicate(s->b, &s->r));
  return motions > 0 ? near_null_space(s, motions, values) : 0;
}

/* A matrix with so many rows on this rank, whose entries come from any rank; those that are named several times are summed. */
int sp_create(int rows, int block, ptrdiff_t entries, int *i, int *j, int symmetric, int motions, const double *values, System **out) {
  System *s = calloc(1, sizeof *s);
  if (!s) return own_error("no memory for a system");
  s->rows = rows;
  int code = create(s, block, entries, i, j, symmetric, motions, values);
  if (code) sp_destroy(s); else *out = s;
  return code;
}

int sp_values(System *s, const double *values) {
  /* Entries that are named several times are summed either way; ADD_VALUES would add to the matrix before. */
  CHECK(MatSetValuesCOO(s->a, values, INSERT_VALUES));
  for (int e = 0; e < ENGINES; e++) if (s->ksp[e]) CHECK(KSPSetOperators(s->ksp[e], s->a, s->a));
  return 0;
}

/* Makes a solver with the options of this prefix. */
int sp_engine(System *s, int e, const char *prefix) {
  CHECK(KSPDestroy(&s->ksp[e]));
  CHECK(KSPCreate(PETSC_COMM_WORLD, &s->ksp[e]));
  CHECK(KSPSetOptionsPrefix(s->ksp[e], prefix));
  CHECK(KSPSetOperators(s->ksp[e], s->a, s->a));
  CHECK(KSPSetFromOptions(s->ksp[e]));
  return 0;
}

/* Factors or preconditioner of the present values. failure: 0 none, 1 a pivot that is zero, 2 no memory, 3 something else. */
int sp_set_up(System *s, int e, int *failure) {
  PC pc;
  PCFailedReason reason;
  CHECK(KSPSetUp(s->ksp[e]));
  CHECK(KSPGetPC(s->ksp[e], &pc));
  CHECK(PCGetFailedReason(pc, &reason));
  *failure = reason == PC_NOERROR ? 0 : reason == PC_FACTOR_NUMERIC_ZEROPIVOT || reason == PC_FACTOR_STRUCT_ZEROPIVOT ? 1 : reason == PC_FACTOR_OUTMEMORY ? 2 : 3;
  return 0;
}

/* The factors, if there are any and MUMPS has made them; else NULL. */
static int mumps_factors(System *s, int e, Mat *factors) {
  PC pc;
  PetscBool lu, cholesky;
  MatSolverType type;
  *factors = NULL;
  if (!s->ksp[e]) return 0;
  CHECK(KSPGetPC(s->ksp[e], &pc));
  CHECK(PetscObjectTypeCompare((PetscObject)pc, PCLU, &lu));
  CHECK(PetscObjectTypeCompare((PetscObject)pc, PCCHOLESKY, &cholesky));
  if (!lu && !cholesky) return 0;
  CHECK(PCFactorGetMatSolverType(pc, &type));
  if (type && !strcmp(type, MATSOLVERMUMPS)) CHECK(PCFactorGetMatrix(pc, factors));
  return 0;
}

/* Pivots of the factors that MUMPS has taken for zero, if it was asked to look for them; and negative ones of symmetric factors, else -1. */
int sp_pivots(System *s, int e, int *null_pivots, int *negative) {
  Mat factors;
  MatFactorType kind;
  PetscInt value;
  *null_pivots = 0; *negative = -1;
  CHECK(mumps_factors(s, e, &factors));
  if (!factors) return 0;
  CHECK(MatMumpsGetInfog(factors, 28, &value));
  *null_pivots = (int)value;
  CHECK(MatGetFactorType(factors, &kind));
  if (kind == MAT_FACTOR_CHOLESKY) { PetscInt below, zero, above; CHECK(MatGetInertia(factors, &below, &zero, &above)); *negative = (int)below; }
  return 0;
}

static int put(Vec vector, const double *from, PetscInt rows) {
  PetscScalar *values;
  CHECK(VecGetArray(vector, &values));
  memcpy(values, from, (size_t)rows * sizeof(double));
  CHECK(VecRestoreArray(vector, &values));
  return 0;
}

static int get(Vec vector, double *to, PetscInt rows) {
  const PetscScalar *values;
  CHECK(VecGetArrayRead(vector, &values));
  memcpy(to, values, (size_t)rows * sizeof(double));
  CHECK(VecRestoreArrayRead(vector, &values));
  return 0;
}

/* numbers: reason of the end, iterations. */
int sp_solve(System *s, int e, double tolerance, const double *b, double *x, int *numbers) {
  KSPConvergedReason reason;
  PetscInt iterations;
  CHECK(put(s->b, b, s->rows));
  if (tolerance > 0.0) CHECK(KSPSetTolerances(s->ksp[e], tolerance, 0.0, PETSC_DEFAULT, PETSC_DEFAULT));
  CHECK(KSPSolve(s->ksp[e], s->b, s->x));
  CHECK(KSPGetConvergedReason(s->ksp[e], &reason));
  CHECK(KSPGetIterationNumber(s->ksp[e], &iterations));
  numbers[0] = (int)reason; numbers[1] = (int)iterations;
  return get(s->x, x, s->rows);
}

/* r = b - A x; norms: 2-norms of r and b, largest entries of r, x and b, largest row sum of |A|. */
int sp_residual(System *s, const double *b, const double *x, double *r, double *norms) {
  CHECK(put(s->b, b, s->rows));
  CHECK(put(s->x, x, s->rows));
  CHECK(MatMult(s->a, s->x, s->r));
  CHECK(VecAYPX(s->r, -1.0, s->b));
  CHECK(VecNorm(s->r, NORM_2, &norms[0]));
  CHECK(VecNorm(s->b, NORM_2, &norms[1]));
  CHECK(VecNorm(s->r, NORM_INFINITY, &norms[2]));
  CHECK(VecNorm(s->x, NORM_INFINITY, &norms[3]));
  CHECK(VecNorm(s->b, NORM_INFINITY, &norms[4]));
  CHECK(MatNorm(s->a, NORM_INFINITY, &norms[5]));
  return get(s->r, r, s->rows);
}

const char *sp_reason(int reason) { return KSPConvergedReasons[reason]; }
int sp_is_indefinite(int reason) { return reason == KSP_DIVERGED_INDEFINITE_MAT || reason == KSP_DIVERGED_INDEFINITE_PC; }

/* Bytes of the matrix on this rank, and those that MUMPS has used for its factors. */
int sp_memory(System *s, double *bytes) {
  MatInfo info;
  Mat factors;
  CHECK(MatGetInfo(s->a, MAT_LOCAL, &info));
  *bytes = info.memory;
  for (int e = 0; e < ENGINES; e++) {
    PetscInt megabytes;
    CHECK(mumps_factors(s, e, &factors));
    if (!factors) continue;
    CHECK(MatMumpsGetInfo(factors, 22, &megabytes));
    *bytes += 1e6 * (double)megabytes;
  }
  return 0;
}
