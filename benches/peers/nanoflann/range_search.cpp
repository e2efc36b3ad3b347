// nanoflann over the points of benches/src/surface_points.rs: what benches/benches/range_search.rs measures, in seconds of the
// fastest of three runs; with --json as {"comparison": seconds}, under the names of benches/benches/peers.rs. Run by run.sh.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <nanoflann.hpp>

struct Points {
    std::vector<std::array<float, 3>> all;
    size_t kdtree_get_point_count() const { return all.size(); }
    float kdtree_get_pt(size_t i, size_t axis) const { return all[i][axis]; }
    template <class Box> bool kdtree_get_bbox(Box&) const { return false; }
};

static Points surface_points(size_t count) {
    uint64_t state = 7;
    auto random = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return float(state >> 40) / float(1 << 24);
    };
    const float pi = 3.14159265f, edge = std::sqrt(pi) * 2.0f;
    Points points;
    points.all.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const float u = random(), v = random();
        if (i % 2 == 0) {
            const float height = 2.0f * u - 1.0f, angle = 2.0f * pi * v;
            const float radius = std::sqrt(std::max(0.0f, 1.0f - height * height));
            points.all.push_back({radius * std::cos(angle), radius * std::sin(angle), height});
        } else {
            points.all.push_back({edge * (u - 0.5f), edge * (v - 0.5f), -1.0f});
        }
    }
    return points;
}

static bool json = false;
static const char* separator = "{";

template <class F> static void measure(const char* name, size_t elements, F&& f) {
    double best = 1e300, check = 0.0;
    for (int run = 0; run < 3; ++run) {
        const auto start = std::chrono::steady_clock::now();
        check = f();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    if (json) {
        std::printf("%s\"range search, %s\": %.9g", separator, name, best);
        separator = ", ";
        return;
    }
    std::printf("%-28s %8.3f s %10.1f ns each (%g)\n", name, best, 1e9 * best / double(elements), check);
}

int main(int argc, char** argv) {
    json = argc > 1 && std::strcmp(argv[1], "--json") == 0;
    if (json) --argc, ++argv;
    const size_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
    const size_t queries = std::min<size_t>(count, 20000), nearest = std::min<size_t>(count, 50);
    const Points points = surface_points(count);
    const float squared_radius = float(50.0 * 8.0 / double(count));
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, uint32_t>;

    measure("build", count, [&] {
        Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
        return double(tree.usedMemory(tree)) / double(count);
    });
    const Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    auto within = [&](size_t from, size_t to) {
        std::vector<std::pair<uint32_t, float>> found;
        double sum = 0.0;
        for (size_t i = from; i < to; ++i) {
            nanoflann::SearchParams parameters;
            parameters.sorted = false;
            tree.radiusSearch(points.all[i].data(), squared_radius, found, parameters);
            for (const auto& [id, distance] : found) sum += distance;
        }
        return sum;
    };
    measure("fixed radius, random order", queries, [&] { return within(0, queries); });
    measure("50 nearest, random order", queries, [&] {
        std::vector<uint32_t> ids(nearest);
        std::vector<float> distances(nearest);
        double sum = 0.0;
        for (size_t i = 0; i < queries; ++i) {
            tree.knnSearch(points.all[i].data(), nearest, ids.data(), distances.data());
            sum += distances[nearest - 1];
        }
        return sum;
    });
    measure("all around all", count, [&] { return within(0, count); });
    if (json) std::printf("}\n");
}
