// TLS 1.3 with certificates on both sides, as a filter between the bytes of a connection and its plain text.
// It has no socket, no thread and no clock of its own. OpenSSL stays inside tls.cc,
// and is loaded with the first context.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace visum::protocol {

// Names of PEM files. Give all three, or none.
struct TlsFiles {
  std::string authority;    // the certificates of the authorities that may sign the peer's certificate
  std::string certificate;  // our own certificate, with the chain that leads to an authority
  std::string key;          // its private key; no other user may have the right to read it
  bool given() const { return !authority.empty() || !certificate.empty() || !key.empty(); }
};

// The default of clients: $VISUM_TLS_CA, $VISUM_TLS_CERT, $VISUM_TLS_KEY.
TlsFiles tls_files_of_environment();

// Keys and rules that all connections of a side share. Immutable: any thread may use it. It must outlive its
// streams.
class TlsContext {
 public:
  enum class Side { kServer, kClient };

  // Throws std::runtime_error with the name of the file that is missing, is wrong, or is a key that other
  // users may read.
  TlsContext(const TlsFiles& files, Side side);
  ~TlsContext();
  TlsContext(const TlsContext&) = delete;
  TlsContext& operator=(const TlsContext&) = delete;

 private:
  friend class TlsStream;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The TLS of one connection. Belongs to the session of that connection, and to its thread. Nothing that a
// peer sends makes it throw: failure() says what was wrong.
class TlsStream {
 public:
  // `host` is for clients: the name or address that the server's certificate must be for.
  explicit TlsStream(const TlsContext& context, const std::string& host = {});
  ~TlsStream();

  // Takes bytes from the network. Call read() then: it deciphers them, and makes the handshake.
  void feed(std::span<const std::byte> bytes);
  // Reads plain text. Returns 0 if it needs more bytes, or the stream has ended or failed.
  std::size_t read(std::span<std::byte> into);
  // Ciphers plain text. Returns how many bytes it took: none before the handshake is over.
  std::size_t write(std::span<const std::byte> bytes);
  // Ends our side of the stream. Nothing may be written after it.
  void finish();

  // The bytes to send over the network. Tell with sent() how many of them were sent.
  std::span<const std::byte> pending();
  void sent(std::size_t bytes);

  bool established() const;                                // both sides have shown their certificates
  bool ended() const { return ended_; }                    // the peer has ended its side
  const std::string& failure() const { return failure_; }  // empty: no failure
  std::string peer_name() const;                           // the common name in the peer's certificate

 private:
  struct Impl;
  bool advance();         // goes on with the handshake; true once it is over
  void note(int result);  // sets ended_ or failure_ by the result of a call to OpenSSL

  std::unique_ptr<Impl> impl_;
  std::vector<std::byte> out_;  // taken from OpenSSL for the network
  std::size_t sent_ = 0;        // of out_
  bool ended_ = false;
  std::string failure_;
};

// True if the first bytes of a connection look like TLS.
bool looks_like_tls(std::span<const std::byte> first);

}  // namespace visum::protocol
