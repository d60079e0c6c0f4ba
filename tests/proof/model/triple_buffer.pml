/* The triple buffer: every interleaving of a producer and a consumer, each slot written and read in two halves.
   What it says: no value is torn, none is older than the one before or than what was published before refresh(), and
   the last one arrives. Memory is sequentially consistent here; memory orders are ThreadSanitizer's part.

   One broken part each: SPLIT_EXCHANGE, NO_FRESH_MARK, TWO_SLOTS. */
#ifndef VALUES
#define VALUES 16
#endif

#ifdef TWO_SLOTS
#define EXCHANGE_BY_PRODUCER atomic { middle = write; fresh = true; write = 1 - write }
#define EXCHANGE_BY_CONSUMER atomic { read = middle; fresh = false }
#elif defined(SPLIT_EXCHANGE)
#define EXCHANGE_BY_PRODUCER atomic { mine = middle; middle = write; fresh = true; write = mine }
#define EXCHANGE_BY_CONSUMER mine = middle; middle = read; fresh = false; read = mine
#else
#define EXCHANGE_BY_PRODUCER atomic { mine = middle; middle = write; fresh = true; write = mine }
#define EXCHANGE_BY_CONSUMER atomic { mine = middle; middle = read; fresh = false; read = mine }
#endif

#ifdef NO_FRESH_MARK
#define IS_FRESH true
#else
#define IS_FRESH fresh
#endif

byte first[3], second[3];  /* the halves of the three slots */
byte middle = 1;
bool fresh = false;
byte published = 0;

active proctype producer() {
  byte write = 0, value = 1, mine;
  do
  :: value <= VALUES ->
     first[write] = value;
     second[write] = value;
     atomic { EXCHANGE_BY_PRODUCER; published = value }
     value++
  :: else -> break
  od
}

active proctype consumer() {
  byte read = 2, last = 0, newest, mine, a, b;
  bool marked;
  do
  :: last < VALUES ->
     newest = published;
     marked = IS_FRESH;
     if
     :: marked ->
        EXCHANGE_BY_CONSUMER;
        a = first[read];
        b = second[read];
        assert(a == b);
        assert(a > last);
        assert(a >= newest);
        last = a
     :: else ->
        assert(newest == last)  /* nothing new means nothing missed */
     fi
  :: else -> break
  od
}
