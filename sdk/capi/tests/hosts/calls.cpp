// Prints what a voice, its asset and the library tell: each line is a name and its values.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include <htex.hpp>

static std::vector<uint8_t> bytes_of(const char *path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

int main(int argc, char **argv)
{
    if (argc != 3)
        return 2;
    std::vector<uint8_t> bytes = bytes_of(argv[1]), packed = bytes_of(argv[2]);
    htex_reader reader{sizeof reader, bytes.size(), bytes.data(),
                       [](void *context, uint64_t offset, uint8_t *buffer, size_t len) -> int32_t {
                           const uint8_t *from = static_cast<const uint8_t *>(context) + offset;
                           std::copy(from, from + len, buffer);
                           return 0;
                       },
                       nullptr};
    htex::OpenOptions open;
    open.engine = htex::Engine::checked;
    auto asset = htex::Asset::open(reader, open);
    if (!asset)
        return std::fprintf(stderr, "%s\n", asset.status().text.c_str()), 1;
    auto library = htex::Library::from_bytes(packed.data(), packed.size());
    std::printf("library %d\n", static_cast<int>(*library->count()));
    std::printf("name %s\n", asset->name()->c_str());
    std::printf("level %.17g\n", *asset->level_rms());
    std::printf("band %.17g %.17g\n", asset->band()->low_hz, asset->band()->high_hz);
    htex::VoiceOptions options;
    options.seed = 7;
    options.gain = 0.5;
    options.limit = 0.01;
    options.envelope_bands = 3;
    auto voice = asset->voice(options);
    std::printf("model %s\n", voice->model()->c_str());
    std::vector<float> samples(4000), sum(4000);
    htex::Envelope envelope;
    double bands[3];
    if (voice->render(samples.data(), samples.size()) || voice->envelope(envelope, bands, 3))
        return 1;
    std::printf("envelope %.17g %.17g %.17g %.17g %.17g\n", envelope.level_rms, envelope.centroid_hz, bands[0],
                bands[1], bands[2]);
    std::printf("edges %.17g %.17g\n", (*voice->envelope_edges(3))[1], (*voice->envelope_edges(3))[2]);
    if (voice->set_gain(-1.0) != HTEX_STATUS_INVALID_ARGUMENT || !voice->reset()
        || voice->render_add(sum.data(), sum.size(), 1.0f))
        return 1;
    std::printf("again %d\n", samples == sum);
    voice->set_motion(htex::motion(0.0, 0.0));
    voice->render(samples.data(), samples.size());
    std::printf("silent %d\n", voice->is_silent());
    std::printf("status %s\n", htex::text_of(HTEX_STATUS_BUSY));
    return htex::shutdown();
}
