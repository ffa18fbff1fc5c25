#include "simulate/fabric.h"

#include <algorithm>
#include <cmath>

namespace toile::simulate {
namespace {

/// Rows of the source's files: (c11, c12, c22, c33) [N/m] without stretch and stretched by 1/6 along the first axis,
/// the bias and the second axis; bending along the first axis, the bias and the second axis at 20 1/m [1e-6 N m].
struct Measured {
    std::string_view name, what;
    double density;  // [kg/m^2]
    double unstretched[4], along_first[4], along_bias[4], along_second[4];
    double bending[3];
};

// clang-format off
constexpr Measured database[] = {
    {"interlock", "T-shirt knit, 60 % cotton 40 % polyester (gray-interlock)", 0.187,
     {16.593832, -14.695990, 34.477123, 36.860302}, {46.364765, 53.694656, 261.013855, -29.691301},
     {123.989220, 105.181770, 365.966217, 44.217571}, {127.443810, 85.848587, 405.872833, 32.238411},
     {34.406498, 16.370552, 14.515154}},
    {"denim", "jeans, 11 oz, 99 % cotton 1 % elastane (11oz-black-denim)", 0.324,
     {205.352005, 10.234077, 1013.88629, 53.387184}, {232.027634, 40.646339, 1052.84289, 64.980499},
     {225.951050, 62.095657, 1059.59741, 83.992020}, {225.767487, 40.917892, 1051.55712, 71.810631},
     {60.943428, 61.080757, 113.060738}},
    {"ponte_roma", "jacket knit, 60 % polyester 40 % rayon (camel-ponte-roma)", 0.284,
     {31.146198, -12.802702, 44.028667, 31.896357}, {78.707756, 26.754574, 268.680725, 27.743423},
     {113.367035, 54.802021, 175.126572, 44.657330}, {143.933365, 49.654823, 191.777588, 39.491055},
     {45.744080, 35.103642, 33.229435}},
    {"rib_knit", "underwear, 95 % cotton 5 % elastane (ivory-rib-knit)", 0.276,
     {42.871021, -0.234556, 65.166023, 83.175644}, {52.422512, 7.219094, 245.337158, -31.129513},
     {91.209549, 4.940307, 109.746452, 27.609430}, {105.649139, 0.416488, 254.593491, 3.472504},
     {83.192772, 30.172081, 38.817448}},
    {"sweater_knit", "sweater, 96 % polyester 4 % elastane (navy-sparkle-sweat)", 0.224,
     {12.486332, -19.875324, 3.272434, 17.616289}, {32.172089, 56.012760, 283.466370, -2.438436},
     {77.093796, 2.958664, 91.251160, 6.107700}, {92.343170, 117.527084, 243.264908, 47.338436},
     {35.787308, 35.206612, 30.734119}},
    {"swim_knit", "swimsuit, 87 % nylon 13 % elastane (white-swim-solid)", 0.204,
     {47.971176, 6.834521, 104.615456, 60.773663}, {40.369045, 23.092957, 169.666290, -24.681890},
     {51.393467, -32.966949, 79.881721, 35.973194}, {68.621185, 40.131950, 124.468513, 36.199604},
     {69.698593, 61.379181, 50.570576}},
    {"polyester_jacket", "light jacket, 100 % polyester (tango-red-jet-set)", 0.113,
     {43.067627, 54.373299, 171.424835, 14.314700}, {75.151695, 82.195221, 236.163773, -7.230383},
     {107.244377, 124.801788, 364.583557, 41.386868}, {227.028687, -21.865427, 404.867188, 62.636021},
     {30.011126, 18.408735, 15.698071}},
    {"polyester_blanket", "blanket, 100 % polyester (pink-ribbon-brown)", 0.228,
     {151.503906, 106.028160, 244.830673, 30.250183}, {164.124344, 33.689709, 268.195221, 30.074625},
     {209.604172, 175.223465, 220.198120, 129.643188}, {96.805817, 54.626881, 359.792633, 30.340616},
     {298.615936, 103.628098, 64.199661}},
    {"cotton_polyester", "trousers, 65 % cotton 35 % polyester (royal-target)", 0.220,
     {2016.55456, 9.170511, 2034.97644, 104.759674}, {2109.51684, 38.604588, 2173.93969, 19.129177},
     {2110.33349, 30.987429, 2135.07910, 121.482445}, {2109.52612, 63.424015, 2152.73852, 39.885654},
     {215.412750, 144.141678, 215.412750}},
    {"polyester_woven", "tablecloth, 100 % polyester (white-dots-on-blk)", 0.128,
     {2002.08618, 0.345588, 2027.48559, 19.189022}, {2107.22753, 36.371597, 2171.73339, 16.904713},
     {2107.73291, 28.389059, 2132.72607, 101.462021}, {2107.30786, 61.216290, 2150.47680, 37.668823},
     {66.360748, 20.847820, 26.350384}},
};
// clang-format on

Fabric converted(const Measured& from) {
    constexpr double share = 0.05 * 6.0;  // of the way from no stretch to 1/6
    const auto at = [&](int entry, double stretched) {
        return std::max(0.0, (1.0 - share) * from.unstretched[entry] + share * stretched);
    };
    const double uu = 2.0 * at(0, from.along_first[0]), vv = 2.0 * at(2, from.along_second[2]);
    const double uv = 2.0 * at(1, 0.5 * (from.along_first[1] + from.along_second[1]));
    const double poisson = std::min(0.49, uv / std::sqrt(uu * vv));
    Fabric fabric{from.name, from.what, {}, 0.0};
    fabric.membrane.density_per_area = from.density;
    fabric.membrane.weft_stiffness = uu * (1.0 - poisson * poisson);
    fabric.membrane.warp_stiffness = vv * (1.0 - poisson * poisson);
    fabric.membrane.shear_stiffness = at(3, from.along_bias[3]);
    fabric.membrane.poisson_ratio = poisson;
    // The bias stands for two of the four directions of a round.
    fabric.bending_stiffness = 1e-6 * (from.bending[0] + 2.0 * from.bending[1] + from.bending[2]) / 4.0 / 4.0;
    return fabric;
}

}  // namespace

const std::vector<Fabric>& measured_fabrics() {
    static const std::vector<Fabric> fabrics = [] {
        std::vector<Fabric> list;
        for (const Measured& one : database) list.push_back(converted(one));
        return list;
    }();
    return fabrics;
}

}  // namespace toile::simulate
