#include "core/recording/decoder.h"

#include <bzlib.h>
#include <glog/logging.h>
#include <lz4frame.h>
#include <zstd.h>

namespace plumbline {
namespace {

class Bz2Decoder : public Decoder {
 public:
  Bz2Decoder() { CHECK_EQ(BZ2_bzDecompressInit(&stream_, 0, 0), BZ_OK); }
  ~Bz2Decoder() override { BZ2_bzDecompressEnd(&stream_); }
  Bz2Decoder(const Bz2Decoder&) = delete;
  Bz2Decoder& operator=(const Bz2Decoder&) = delete;

  Step Run(ByteView in, uint8_t* out, size_t out_size) override {
    // The interface predates const; the input is only read.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data));
    stream_.avail_in = static_cast<unsigned>(in.size);
    stream_.next_out = reinterpret_cast<char*>(out);
    stream_.avail_out = static_cast<unsigned>(out_size);
    const int outcome = BZ2_bzDecompress(&stream_);
    Step step;
    step.num_taken = in.size - stream_.avail_in;
    step.num_given = out_size - stream_.avail_out;
    step.at_end = outcome == BZ_STREAM_END;
    step.failed = outcome != BZ_OK && outcome != BZ_STREAM_END;
    return step;
  }

 private:
  bz_stream stream_ = {};
};

class Lz4Decoder : public Decoder {
 public:
  Lz4Decoder() {
    CHECK(!LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)));
  }
  ~Lz4Decoder() override { LZ4F_freeDecompressionContext(context_); }
  Lz4Decoder(const Lz4Decoder&) = delete;
  Lz4Decoder& operator=(const Lz4Decoder&) = delete;

  Step Run(ByteView in, uint8_t* out, size_t out_size) override {
    Step step;
    step.num_taken = in.size;
    step.num_given = out_size;
    const size_t outcome =
        LZ4F_decompress(context_, out, &step.num_given, in.data, &step.num_taken, nullptr);
    step.failed = LZ4F_isError(outcome) != 0;
    step.at_end = outcome == 0;
    if (step.failed) step.num_taken = step.num_given = 0;
    return step;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

class ZstdDecoder : public Decoder {
 public:
  ZstdDecoder() : stream_(ZSTD_createDStream()) {
    CHECK(stream_ != nullptr);
    // The header of a frame may ask for no more memory than this.
    CHECK(!ZSTD_isError(ZSTD_DCtx_setParameter(stream_, ZSTD_d_windowLogMax, kMaxWindowLog)));
  }
  ~ZstdDecoder() override { ZSTD_freeDStream(stream_); }
  ZstdDecoder(const ZstdDecoder&) = delete;
  ZstdDecoder& operator=(const ZstdDecoder&) = delete;

  Step Run(ByteView in, uint8_t* out, size_t out_size) override {
    ZSTD_inBuffer packed = {in.data, in.size, 0};
    ZSTD_outBuffer unpacked = {out, out_size, 0};
    const size_t outcome = ZSTD_decompressStream(stream_, &unpacked, &packed);
    Step step;
    step.failed = ZSTD_isError(outcome) != 0;
    step.at_end = outcome == 0;
    if (!step.failed) {
      step.num_taken = packed.pos;
      step.num_given = unpacked.pos;
    }
    return step;
  }

 private:
  static constexpr int kMaxWindowLog = 27;  // zstd's own limit for those who do not ask

  ZSTD_DStream* stream_;
};

}  // namespace

std::unique_ptr<Decoder> MakeDecoder(const std::string& compression) {
  if (compression == "bz2") return std::make_unique<Bz2Decoder>();
  if (compression == "lz4") return std::make_unique<Lz4Decoder>();
  if (compression == "zstd") return std::make_unique<ZstdDecoder>();
  return nullptr;
}

}  // namespace plumbline
