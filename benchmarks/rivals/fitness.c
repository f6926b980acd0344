/* KG18's fitness of many chromosomes in C, for benchmarks/questions/fitness.py: the fastest form found.

   Limits: 5 control points, all on the map, 5 way points, diagonal steps past obstacles allowed,
   maps of at most 255 x 255 fields. They are known at compile time or save tests:
   - way points lie on the map as well, so no line leaves it and no coordinate is negative;
   - a line has n < 255 steps, so 22 fractional bits are enough: a slope is rounded up, a position
     comes to lie at most n / 2^22 too high, and the exact one is a multiple of 1 / (2 n), so no
     field changes while 4 n^2 < 2^22 (gapath/kernels/raster.py); positions fit 31 bits;
   - an entry of the table is a weight of at most 2^16, or 2^24 for an obstacle: one sum of up to
     255 entries holds both.

   The compiler may contract a * b + c: a way point's sum is kept 1 / (4 d) away from every integer
   (gapath/kernels/kg18/bspline.py), and a slope is one quotient, whose fraction has bits to spare. */

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <stdlib.h>

enum { CONTROL_POINTS = 5, WAY_POINTS = 5, TERMS = 3 };
enum { SHIFT = 22, HALF = 1 << (SHIFT - 1) };
enum { OBSTACLE_BITS = 24, WEIGHT_MASK = (1 << OBSTACLE_BITS) - 1, KEY_BITS = 44 };

/* A way point: the control points that count, of five, and by how much. */
typedef struct {
    int first;
    const double *weights;
    double rounding;
} WayPoint;

static void make_way_points(WayPoint *points, const double *weights, const double *rounding)
{
    for (int j = 0; j < WAY_POINTS; j++) {
        const double *row = weights + j * CONTROL_POINTS;
        int first = 0;
        while (first < CONTROL_POINTS - TERMS && row[first] == 0)
            first++;
        points[j] = (WayPoint){first, row + first, rounding[j]};
    }
}

static inline int32_t coordinate(const int32_t *chromosome, const WayPoint *point, int axis)
{
    const int32_t *gene = chromosome + 2 * point->first + axis;
    const double *weight = point->weights;
    return (int32_t)(point->rounding + weight[0] * gene[0] + weight[1] * gene[2]
                     + weight[2] * gene[4]);
}

/* One field after the other: along its longer axis a line takes one field a step, and where it is
   across is a fraction. */
void plain(const int32_t *restrict table, int64_t cols,
           const int32_t *restrict chromosomes, int64_t stride, int64_t count,
           const double *weights, const double *rounding, int64_t *restrict keys)
{
    WayPoint points[WAY_POINTS];
    make_way_points(points, weights, rounding);
    for (int64_t c = 0; c < count; c++) {
        const int32_t *chromosome = chromosomes + c * stride;
        int32_t x0 = coordinate(chromosome, points, 0), y0 = coordinate(chromosome, points, 1);
        int64_t obstacles = 0, cost = 0, sum = table[y0 * cols + x0];
        for (int j = 1; j < WAY_POINTS; j++) {
            int32_t x1 = coordinate(chromosome, points + j, 0);
            int32_t y1 = coordinate(chromosome, points + j, 1);
            int32_t dx = x1 - x0, dy = y1 - y0;
            int tall = abs(dy) > abs(dx);
            int32_t n = tall ? abs(dy) : abs(dx);
            int64_t along = tall ? (dy < 0 ? -cols : cols) : (dx < 0 ? -1 : 1);
            int64_t across = tall ? 1 : cols;
            double d = (double)(tall ? dx : dy) * (1 << SHIFT);
            int64_t slope = (int64_t)ceil(d / (n ? n : 1)), position = HALF;
            const int32_t *at = table + y0 * cols + x0;
#pragma GCC unroll 4
            for (int32_t i = 0; i < n; i++) {
                at += along;
                position += slope;
                sum += at[(position >> SHIFT) * across];
            }
            obstacles += sum >> OBSTACLE_BITS;
            cost += sum & WEIGHT_MASK;
            sum = 0;
            x0 = x1;
            y0 = y1;
        }
        keys[c] = (obstacles << KEY_BITS) + cost;
    }
}

/* What it takes to read the table at places known beforehand, and nothing else. Two places are read
   at once, and four sums need not wait for one another. */
void indices(const int32_t *restrict table, const int32_t *restrict places,
             const int64_t *restrict ends, int64_t count, int64_t *restrict sums)
{
    for (int64_t c = 0; c < count; c++) {
        uint32_t part[4] = {0};
        int64_t i = ends[c];
        for (; i + 8 <= ends[c + 1]; i += 8)
            for (int k = 0; k < 4; k++) {
                uint64_t pair;
                memcpy(&pair, places + i + 2 * k, sizeof pair);
                part[k] += table[(uint32_t)pair];
                part[k] += table[pair >> 32];
            }
        for (; i < ends[c + 1]; i++)
            part[0] += table[places[i]];
        sums[c] = (int64_t)part[0] + part[1] + part[2] + part[3];
    }
}

#ifdef __AVX512F__
#include <immintrin.h>

enum { LANES = 16, LINES = WAY_POINTS - 1, MOST_PLACES = 1 + LINES * 254 };

static inline __m512i all_lanes(__m256i numbers, int lane)
{
    return _mm512_permutexvar_epi32(_mm512_set1_epi32(lane), _mm512_castsi256_si512(numbers));
}

/* All ten coordinates of a chromosome at once, then both axes of its four lines, then the places of
   the fields, 16 at a time and one line behind the other, and at last the entries: gathered 16 at a
   time, the last ones under a mask.

   On Zen 4, where this was tuned, it takes 5 to 17 % longer to gather line by line without storing
   the places, since then four masks, not one, leave lanes idle; 8 lanes take as long as 16. */
void gathers(const int32_t *restrict table, int64_t cols,
             const int32_t *restrict chromosomes, int64_t stride, int64_t count,
             const double *weights, const double *rounding, int64_t *restrict keys)
{
    WayPoint points[WAY_POINTS];
    make_way_points(points, weights, rounding);
    int32_t genes[TERMS][LANES] = {0};
    double factors[TERMS][LANES] = {0}, roundings[LANES] = {0};
    for (int lane = 0; lane < 2 * WAY_POINTS; lane++) { /* x0, y0, x1, y1, ... */
        const WayPoint *point = points + lane / 2;
        roundings[lane] = point->rounding;
        for (int t = 0; t < TERMS; t++) {
            genes[t][lane] = 2 * (point->first + t) + lane % 2;
            factors[t][lane] = point->weights[t];
        }
    }
    const __m512i ends = _mm512_setr_epi32(2, 3, 4, 5, 6, 7, 16, 17, 0, 0, 0, 0, 0, 0, 0, 0);
    const __m512i step = _mm512_setr_epi32(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
    const __m512i width = _mm512_set1_epi32(cols);
    int32_t places[MOST_PLACES + 2 * LANES];

    for (int64_t c = 0; c < count; c++) {
        const __m512i chromosome = _mm512_loadu_si512(chromosomes + c * stride);
        __m512d low = _mm512_loadu_pd(roundings), high = _mm512_loadu_pd(roundings + 8);
        for (int t = 0; t < TERMS; t++) {
            __m512i gene = _mm512_permutexvar_epi32(_mm512_loadu_si512(genes[t]), chromosome);
            __m512d gene_low = _mm512_cvtepi32_pd(_mm512_castsi512_si256(gene));
            __m512d gene_high = _mm512_cvtepi32_pd(_mm512_extracti64x4_epi64(gene, 1));
            low = _mm512_fmadd_pd(_mm512_loadu_pd(factors[t]), gene_low, low);
            high = _mm512_fmadd_pd(_mm512_loadu_pd(factors[t] + 8), gene_high, high);
        }
        __m256i start = _mm512_cvttpd_epi32(low), last = _mm512_cvttpd_epi32(high);
        __m256i end = _mm512_castsi512_si256(_mm512_permutex2var_epi32(
            _mm512_castsi256_si512(start), ends, _mm512_castsi256_si512(last)));

        __m256i d = _mm256_sub_epi32(end, start), size = _mm256_abs_epi32(d);
        __m256i n = _mm256_max_epi32(size, _mm256_shuffle_epi32(size, _MM_SHUFFLE(2, 3, 0, 1)));
        __m512d quotient = _mm512_div_pd(
            _mm512_mul_pd(_mm512_cvtepi32_pd(d), _mm512_set1_pd(1 << SHIFT)),
            _mm512_cvtepi32_pd(_mm256_max_epi32(n, _mm256_set1_epi32(1))));
        __m256i slope = _mm512_cvttpd_epi32(
            _mm512_roundscale_pd(quotient, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC));
        __m256i centre = _mm256_add_epi32(_mm256_slli_epi32(start, SHIFT), _mm256_set1_epi32(HALF));
        int32_t steps[2 * LINES];
        _mm256_storeu_si256((__m256i *)steps, n);

        int32_t total = 1;
        places[0] = _mm256_extract_epi32(start, 1) * cols + _mm256_extract_epi32(start, 0);
#pragma GCC unroll 4
        for (int j = 0; j < LINES; j++) {
            const int x_lane = 2 * j, y_lane = 2 * j + 1;
            __m512i slope_x = all_lanes(slope, x_lane), slope_y = all_lanes(slope, y_lane);
            __m512i x = all_lanes(centre, x_lane), y = all_lanes(centre, y_lane);
            x = _mm512_add_epi32(x, _mm512_mullo_epi32(slope_x, step));
            y = _mm512_add_epi32(y, _mm512_mullo_epi32(slope_y, step));
            slope_x = _mm512_slli_epi32(slope_x, 4); /* of 16 steps */
            slope_y = _mm512_slli_epi32(slope_y, 4);
            int32_t *to = places + total;
            /* What is stored behind a line's end is overwritten; most lines take one round. */
            for (int32_t i = 0; i < steps[x_lane]; i += 2 * LANES)
                for (int half = 0; half < 2; half++, to += LANES) {
                    __m512i row = _mm512_mullo_epi32(_mm512_srai_epi32(y, SHIFT), width);
                    _mm512_storeu_si512(to, _mm512_add_epi32(row, _mm512_srai_epi32(x, SHIFT)));
                    x = _mm512_add_epi32(x, slope_x);
                    y = _mm512_add_epi32(y, slope_y);
                }
            total += steps[x_lane];
        }

        __m512i sum = _mm512_setzero_si512();
        int32_t i = 0;
        for (; i + LANES <= total; i += LANES)
            sum = _mm512_add_epi32(
                sum, _mm512_i32gather_epi32(_mm512_loadu_si512(places + i), table, 4));
        __mmask16 rest = (1 << (total - i)) - 1;
        sum = _mm512_add_epi32(
            sum, _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), rest,
                                             _mm512_loadu_si512(places + i), table, 4));
        const __m512i weight_mask = _mm512_set1_epi32(WEIGHT_MASK);
        int64_t obstacles = _mm512_reduce_add_epi32(_mm512_srli_epi32(sum, OBSTACLE_BITS));
        int64_t cost = _mm512_reduce_add_epi32(_mm512_and_si512(sum, weight_mask));
        keys[c] = (obstacles << KEY_BITS) + cost;
    }
}
#endif
